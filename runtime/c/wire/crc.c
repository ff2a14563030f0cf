#ifndef ICDGEN_WIRE_CRC_C
#define ICDGEN_WIRE_CRC_C

#include "crc.h"

ICDGEN_API void icd_crc_init(icd_crc_t *crc, const icd_crc_form_t *form)
{
    crc->form = form;
    crc->value = form->init;
    crc->fed = false;
}

static inline uint32_t icdgen_reflected(uint32_t value, unsigned width)
{
    uint32_t reflected = 0;
    for (unsigned i = 0; i < width; ++i) {
        reflected = (reflected << 1) | ((value >> i) & 1u);
    }
    return reflected;
}

/* Reverse the bits of a byte: swap halves, then quarters, then bits. */
static inline uint32_t icdgen_reflected_byte(uint32_t byte)
{
    const uint32_t halves = ((byte & 0x0Fu) << 4) | (byte >> 4);
    const uint32_t quarters = ((halves & 0x33u) << 2) | ((halves >> 2) & 0x33u);
    return ((quarters & 0x55u) << 1) | ((quarters >> 1) & 0x55u);
}

ICDGEN_API void icd_crc_feed(icd_crc_t *crc, const uint8_t *bytes, size_t length)
{
    const icd_crc_form_t *const form = crc->form;
    const unsigned width = ICDGEN_CAST(unsigned, form->width);
    const uint32_t mask = UINT32_C(0xFFFFFFFF) >> (32u - width);
    const uint32_t top = UINT32_C(1) << (width - 1u);
#ifndef ICDGEN_NO_TABLES
    const unsigned beyond = width > 8u ? width - 8u : 0u;  /* bits of the register below the byte */
    const unsigned missing = width < 8u ? 8u - width : 0u; /* bits of the byte below the register */
#endif
    uint32_t value = crc->value;
    for (size_t i = 0; i < length; ++i) {
        const uint32_t byte = form->reflect_in ? icdgen_reflected_byte(bytes[i]) : bytes[i];
#ifndef ICDGEN_NO_TABLES
        if ((form->table8 != NULL) || (form->table16 != NULL)) {
            const uint32_t row = (((value >> beyond) << missing) ^ byte) & 0xFFu;
            uint32_t entry;
            if (form->table8 != NULL) {
                entry = form->table8[row];
            } else {
                entry = form->table16[row];
            }
            value = ((value << 8) ^ entry) & mask;
            continue;
        }
#endif
        for (unsigned bit = 0; bit < 8u; ++bit) {
            const bool out = ((value & top) != 0u) != (((byte >> (7u - bit)) & 1u) != 0u);
            value = ((value << 1) & mask) ^ (out ? form->polynomial : 0u);
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
    return (form->reflect_out ? icdgen_reflected(crc->value, ICDGEN_CAST(unsigned, form->width)) : crc->value) ^
        form->xor_out;
}

ICDGEN_API uint32_t icd_crc(const icd_crc_form_t *form, const uint8_t *bytes, size_t length)
{
    icd_crc_t crc;
    icd_crc_init(&crc, form);
    icd_crc_feed(&crc, bytes, length);
    return icd_crc_result(&crc);
}

ICDGEN_API icd_status_t icd_crc8(const icd_link_t *link, const uint8_t *bytes, size_t length, uint32_t *crc)
{
    if (link->checksum == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    *crc = icd_crc(&link->checksum->crc, bytes, length);
    return ICD_OK;
}

ICDGEN_API icd_status_t icd_crc16(const icd_link_t *link, const uint8_t *bytes, size_t length, uint32_t *crc)
{
    if (link->crc16 == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    *crc = icd_crc(link->crc16, bytes, length);
    return ICD_OK;
}

#endif /* ICDGEN_WIRE_CRC_C */
