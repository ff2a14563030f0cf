#ifndef ICDGEN_WIRE_CHECKSUM_C
#define ICDGEN_WIRE_CHECKSUM_C

#include "checksum.h"
#include "crc.c"

ICDGEN_API uint32_t icd_checksum(const icd_checksum_algorithm_t *algorithm, const uint8_t *bytes, size_t length)
{
    icdgen_check_t check;
    icdgen_check_begin(&check, algorithm);
    icdgen_check_feed(&check, bytes, length);
    return icdgen_check_result(&check);
}

#endif /* ICDGEN_WIRE_CHECKSUM_C */
