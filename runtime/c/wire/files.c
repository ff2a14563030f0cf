#ifndef ICDGEN_WIRE_FILES_C
#define ICDGEN_WIRE_FILES_C

#include "files.h"
#include "link.c"

static inline uint8_t icdgen_hole_bit(const icd_hole_map_form_t *form, uint32_t position)
{
    return ICDGEN_U8(1u << (form->msb0 ? 7u - (position % 8u) : position % 8u));
}

static inline void icdgen_hole_put(const icd_hole_map_form_t *form, uint8_t *map, uint32_t position, bool one)
{
    const uint8_t bit = icdgen_hole_bit(form, position);
    map[position / 8u] = ICDGEN_U8(one ? map[position / 8u] | bit : map[position / 8u] & ~ICDGEN_U32(bit));
}

ICDGEN_API icd_status_t icd_hole_map_init(const icd_link_t *link, uint8_t *map, uint32_t packets)
{
    const icd_hole_map_form_t *const form = link->hole_map;
    if (form == NULL || link->files == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (packets > form->bytes * 8u) {
        return ICD_ERROR_RANGE;
    }
    for (uint32_t i = 0; i < form->bytes * 8u; ++i) {
        icdgen_hole_put(form, map, i, i < packets ? !form->received : form->beyond_end);
    }
    return ICD_OK;
}

ICDGEN_API icd_status_t icd_hole_map_set(const icd_link_t *link, uint8_t *map, uint32_t packets, uint32_t number)
{
    const icd_hole_map_form_t *const form = link->hole_map;
    uint32_t position;
    if (form == NULL || link->files == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    position = number - link->files->first_packet;
    if (position >= packets || position >= form->bytes * 8u) {
        return ICD_ERROR_RANGE;
    }
    icdgen_hole_put(form, map, position, form->received);
    return ICD_OK;
}

ICDGEN_API bool icd_hole_map_get(const icd_link_t *link, const uint8_t *map, uint32_t number)
{
    const icd_hole_map_form_t *const form = link->hole_map;
    uint32_t position;
    if (form == NULL || link->files == NULL) {
        return false;
    }
    position = number - link->files->first_packet;
    return position < form->bytes * 8u &&
        ((map[position / 8u] & icdgen_hole_bit(form, position)) != 0u) == form->received;
}

ICDGEN_API uint32_t icd_hole_map_count(const icd_link_t *link, const uint8_t *map, uint32_t packets)
{
    uint32_t count = 0;
    for (uint32_t i = 0; link->files != NULL && i < packets; ++i) {
        count += icd_hole_map_get(link, map, link->files->first_packet + i) ? 0u : 1u;
    }
    return count;
}

ICDGEN_API icd_status_t
icd_index_entry_decode(const icd_link_t *link, const uint8_t *bytes, size_t length, icd_index_entry_t *entry)
{
    const icd_index_form_t *const form = link->index;
    if (form == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (length != form->entry_bytes) {
        return ICD_ERROR_LENGTH;
    }
    entry->type = icdgen_number(link, bytes + form->type.at, form->type.bytes);
    entry->counter = icdgen_number(link, bytes + form->counter.at, form->counter.bytes);
    entry->checksum = icdgen_number(link, bytes + form->checksum.at, form->checksum.bytes);
    entry->size = icdgen_number(link, bytes + form->size.at, form->size.bytes);
    entry->time = icdgen_number(link, bytes + form->time.at, form->time.bytes);
    entry->meta = bytes + form->meta.at;
    entry->meta_length = form->meta.bytes;
    return ICD_OK;
}

ICDGEN_API icd_status_t
icd_index_entry_encode(const icd_link_t *link, const icd_index_entry_t *entry, uint8_t *bytes, size_t capacity)
{
    const icd_index_form_t *const form = link->index;
    if (form == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (capacity < form->entry_bytes) {
        return ICD_ERROR_LENGTH;
    }
    (void)memset(bytes, 0, form->entry_bytes);
    if (icdgen_put_number(link, bytes + form->type.at, form->type.bytes, entry->type) != ICD_OK ||
        icdgen_put_number(link, bytes + form->counter.at, form->counter.bytes, entry->counter) != ICD_OK ||
        icdgen_put_number(link, bytes + form->checksum.at, form->checksum.bytes, entry->checksum) != ICD_OK ||
        icdgen_put_number(link, bytes + form->size.at, form->size.bytes, entry->size) != ICD_OK ||
        icdgen_put_number(link, bytes + form->time.at, form->time.bytes, entry->time) != ICD_OK) {
        return ICD_ERROR_RANGE;
    }
    if (entry->meta_length != form->meta.bytes) {
        return ICD_ERROR_LENGTH;
    }
    if (entry->meta_length != 0u) {
        (void)memcpy(bytes + form->meta.at, entry->meta, entry->meta_length);
    }
    return ICD_OK;
}

#endif /* ICDGEN_WIRE_FILES_C */
