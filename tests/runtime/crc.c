/*
 * The CRC of the digits 1 to 9, in pieces of which some are empty; its parameters are the arguments. The CRC of no bytes
 * is another one.
 */
#include "wire/crc.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    static const uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
    static uint8_t table8[256];
    static uint16_t table16[256];
    icd_crc_form_t form = {0};
    icd_crc_form_t zero = {0};
    icd_crc_t crc;
    if (argc != 7) {
        return 2;
    }
    form.width = (uint8_t)strtoul(argv[1], NULL, 10);
    form.polynomial = (uint32_t)strtoul(argv[2], NULL, 10);
    form.init = (uint32_t)strtoul(argv[3], NULL, 10);
    form.reflect_in = argv[4][0] == '1';
    form.reflect_out = argv[5][0] == '1';
    form.xor_out = (uint32_t)strtoul(argv[6], NULL, 10);
    form.has_empty = true;
    form.empty = 0xA5u;
    icd_crc_init(&crc, &form);
    icd_crc_feed(&crc, digits, 0);
    if (icd_crc_result(&crc) != form.empty || icd_crc(&form, digits, 0) != form.empty) {
        return 1;
    }
    icd_crc_feed(&crc, digits, 4);
    icd_crc_feed(&crc, digits + 4, 5);
    icd_crc_feed(&crc, digits, 0);
    if (icd_crc_result(&crc) != icd_crc(&form, digits, sizeof digits)) {
        return 1;
    }
    zero.width = form.width;
    zero.polynomial = form.polynomial;
    zero.reflect_in = form.reflect_in; /* the register is reflected then, and so is the table */
    zero.reflect_out = form.reflect_in;
    for (unsigned i = 0; i < 256u; ++i) {
        const uint8_t byte = (uint8_t)i;
        table8[i] = (uint8_t)icd_crc(&zero, &byte, 1);
        table16[i] = (uint16_t)icd_crc(&zero, &byte, 1);
    }
    form.table8 = form.width <= 8u ? table8 : NULL;
    form.table16 = form.width > 8u && form.width <= 16u ? table16 : NULL;
    if (icd_crc_result(&crc) != icd_crc(&form, digits, sizeof digits)) {
        return 1;
    }
    printf("%lu\n", (unsigned long)icd_crc_result(&crc));
    return 0;
}
