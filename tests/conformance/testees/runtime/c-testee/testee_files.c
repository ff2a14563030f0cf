/* What files are about: packed times and the index file. */

#include "testee_wire.h"

/* ---- packed time ---------------------------------------------------------------------------------------------------------- */

static void dos_time_unpack(void)
{
    const icd_link_t *link = next_link();
    icd_dos_time_t time;
    if (answers(icd_dos_time_unpack(link, next_number(), &time))) {
        put_number("year", time.year);
        put_number("month", time.month);
        put_number("day", time.day);
        put_number("hour", time.hour);
        put_number("minute", time.minute);
        put_number("second", time.second);
        put_number("valid", icd_dos_time_wrong(&time) == NULL);
    }
}

static void dos_time_pack(void)
{
    const icd_link_t *link = next_link();
    const char *wrong = NULL;
    uint32_t value = 0;
    icd_dos_time_t time;
    icd_status_t status;
    time.year = (uint16_t)next_number();
    time.month = (uint16_t)next_number();
    time.day = (uint16_t)next_number();
    time.hour = (uint16_t)next_number();
    time.minute = (uint16_t)next_number();
    time.second = (uint16_t)next_number();
    status = icd_dos_time_pack(link, &time, &value, &wrong);
    if (answers(status)) {
        put_number("value", value);
    } else if (status == ICD_ERROR_RANGE) {
        put_text("field", wrong);
    }
}

/* ---- the index file ---------------------------------------------------------------------------------------------------- */

static void index_decode(void)
{
    const icd_link_t *link = next_link();
    const octets_t octets = next_octets();
    icd_index_entry_t entry;
    size_t at, size;
    if (!answers(link->index != NULL ? ICD_OK : ICD_ERROR_UNSUPPORTED)) {
        return;
    }
    size = link->index->entry_bytes;
    for (at = 0; octets.length - at >= size; at += size) {
        if (icd_index_entry_decode(link, octets.data + at, size, &entry) != ICD_OK) {
            break;
        }
        put_row("entry");
        put_number("type", entry.type);
        put_number("counter", entry.counter);
        put_number("checksum", entry.checksum);
        put_number("size", entry.size);
        put_number("time", entry.time);
        put_octets("meta", entry.meta, entry.meta_length);
    }
    put_row("ok");
    put_number("truncated", octets.length - at);
}

static void index_encode(void)
{
    const icd_link_t *link = next_link();
    const size_t size = link->index != NULL ? link->index->entry_bytes : 0u;
    uint8_t *buffer = (uint8_t *)memory(size);
    icd_status_t status = link->index != NULL ? ICD_OK : ICD_ERROR_UNSUPPORTED;
    put_row("ok");
    put_list("bytes");
    while (status == ICD_OK && has_words()) {
        icd_index_entry_t entry;
        octets_t meta;
        entry.type = next_number();
        entry.counter = next_number();
        entry.checksum = next_number();
        entry.size = next_number();
        entry.time = next_number();
        meta = next_octets();
        entry.meta = meta.data;
        entry.meta_length = meta.length;
        status = icd_index_entry_encode(link, &entry, buffer, size);
        put_octets_item(buffer, size);
        if (status == ICD_ERROR_LENGTH) {
            refuse_length("length", link->index->meta.bytes, meta.length);
            return;
        }
    }
    if (status != ICD_OK) {
        refuse_status(status);
    }
}

const testee_op_t testee_file_ops[] = {
    {"dos_time_unpack", dos_time_unpack},
    {"dos_time_pack", dos_time_pack},
    {"index_decode", index_decode},
    {"index_encode", index_encode},
    {NULL, NULL},
};
