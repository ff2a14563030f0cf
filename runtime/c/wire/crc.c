#ifndef ICDGEN_WIRE_CRC_C
#define ICDGEN_WIRE_CRC_C

#include "crc.h"

static inline uint32_t icdgen_reflected(uint32_t value, unsigned width)
{
    uint32_t reflected = 0;
    for (unsigned i = 0; i < width; ++i) {
        reflected = (reflected << 1) | ((value >> i) & 1u);
    }
    return reflected;
}

/*
 * The register of a CRC is left-aligned in 32 bits. If bytes enter least significant bit first, it is reflected and
 * right-aligned instead: otherwise each byte would have to be reflected.
 */
static inline uint32_t icdgen_crc_aligned(const icd_crc_form_t *form, uint32_t value)
{
    return form->reflect_in ? icdgen_reflected(value, ICDGEN_CAST(unsigned, form->width))
                            : value << (32u - form->width);
}

ICDGEN_API void icd_crc_init(icd_crc_t *crc, const icd_crc_form_t *form)
{
    crc->form = form;
    crc->value = icdgen_crc_aligned(form, form->init);
    crc->fed = false;
}

ICDGEN_API void icd_crc_feed(icd_crc_t *crc, const uint8_t *bytes, size_t length)
{
    const icd_crc_form_t *const form = crc->form;
    const bool reflect = form->reflect_in;
    const uint32_t polynomial = icdgen_crc_aligned(form, form->polynomial);
    uint32_t value = crc->value;
    size_t i = 0;
#ifndef ICDGEN_NO_TABLES
    const uint32_t shift = reflect ? 0u : 32u - form->width;
    /* One loop for each way of looking up: most of the time of a decoder is spent here. */
    for (; form->table16 != NULL && reflect && i < length; ++i) {
        value = (value >> 8) ^ form->table16[(value ^ bytes[i]) & 0xFFu];
    }
    for (; form->table16 != NULL && i < length; ++i) {
        value = (value << 8) ^ (ICDGEN_U32(form->table16[(value >> 24) ^ bytes[i]]) << shift);
    }
    for (; form->table8 != NULL && i < length; ++i) {
        const uint32_t row = ((reflect ? value : value >> 24) ^ bytes[i]) & 0xFFu;
        value = (reflect ? value >> 8 : value << 8) ^ (ICDGEN_U32(form->table8[row]) << shift);
    }
#endif
    for (; i < length; ++i) {
        value ^= reflect ? bytes[i] : ICDGEN_U32(bytes[i]) << 24;
        for (unsigned bit = 0; bit < 8u; ++bit) {
            const bool out = (reflect ? value & 1u : value >> 31) != 0u;
            value = (reflect ? value >> 1 : value << 1) ^ (out ? polynomial : 0u);
        }
    }
    crc->value = value;
    crc->fed = crc->fed || length != 0u;
}

ICDGEN_API uint32_t icd_crc_result(const icd_crc_t *crc)
{
    const icd_crc_form_t *const form = crc->form;
    if (!crc->fed && form->has_empty) {
        return form->empty;
    }
    const uint32_t value = form->reflect_in ? crc->value : crc->value >> (32u - form->width);
    return (form->reflect_in != form->reflect_out ? icdgen_reflected(value, ICDGEN_CAST(unsigned, form->width))
                                                  : value) ^
        form->xor_out;
}

ICDGEN_API uint32_t icd_crc(const icd_crc_form_t *form, const uint8_t *bytes, size_t length)
{
    icd_crc_t crc;
    icd_crc_init(&crc, form);
    icd_crc_feed(&crc, bytes, length);
    return icd_crc_result(&crc);
}

#endif /* ICDGEN_WIRE_CRC_C */
