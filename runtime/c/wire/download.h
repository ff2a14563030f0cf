#ifndef ICDGEN_WIRE_DOWNLOAD_H
#define ICDGEN_WIRE_DOWNLOAD_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "crc.h"
#include "files.h"
#include "procedure.h"

/** Is told of each block of a file. */
typedef void icd_block_fn(void *context, uint32_t offset, const uint8_t *data, size_t length);

/** The size of a file of which nothing but its end will tell, such as the index file. */
#define ICD_SIZE_UNKNOWN UINT32_C(0xFFFFFFFF)

/** Downloads a file block by block. `procedure` goes to the functions of icd_procedure_t. */
typedef struct {
    icd_procedure_t procedure;
    icd_bus_t bus;
    uint8_t type;
    uint8_t counter;
    uint32_t size;
    uint32_t block; /* bytes asked for at once */
    uint8_t *buffer;
    uint8_t *got; /* a bit for each packet of the block */
    icd_block_fn *on_block;
    void *context;
    uint32_t offset;   /**< Progress: bytes delivered. */
    uint32_t length;   /* of this block */
    uint32_t checksum; /* of this block */
    uint32_t count;    /* packets of this block */
    uint32_t there;    /* of them */
    uint32_t rounds;
    uint32_t left; /* I2C, CAN: packets still to be requested; messages of the hole map sent */
    uint32_t last; /* when the last packet came */
} icd_download_t;

/** Bytes of the buffer and of the bitmap for blocks of at most `block` bytes. */
ICDGEN_API size_t icd_block_buffer(const icd_link_t *link, uint32_t block);

ICDGEN_API size_t icd_block_bitmap(const icd_link_t *link, uint32_t block);

/**
 * `size`: bytes of the file, or ICD_SIZE_UNKNOWN. `block`: bytes asked for at once, 0 for those of the ICD. `buffer`
 * holds icd_block_buffer() bytes, `bitmap` icd_block_bitmap().
 */
ICDGEN_API icd_status_t icd_download_init(
    icd_download_t *download,
    const icd_link_t *link,
    icd_bus_t bus,
    uint8_t type,
    uint8_t counter,
    uint32_t size,
    uint32_t block,
    uint8_t *buffer,
    uint8_t *bitmap,
    icd_block_fn *on_block,
    void *context);

#endif /* ICDGEN_WIRE_DOWNLOAD_H */
