#ifndef ICDGEN_WIRE_FILES_C
#define ICDGEN_WIRE_FILES_C

#include "files.h"
#include "link.c"

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
