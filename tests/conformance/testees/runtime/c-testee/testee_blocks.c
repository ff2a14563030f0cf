/* Packed times, hole maps, the index file and the identity. */

#include "testee_wire.h"

/* ---- packed time ----------------------------------------------------------------------------------------------------- */

void dos_time(talk_t *talk, const icd_link_t *link)
{
    static const char *const names[] = {"year", "month", "day", "hour", "minute", "second"};
    icd_dos_time_t time;
    icd_status_t status;
    uint32_t value = 0, parts[6];
    const char *wrong = NULL;
    size_t i;
    if (json_find(&talk->row, 0, "value") != 0u) {
        if (!ask_number(talk, 0, "value", 0, MOST_NUMBER, REQUIRED, &value)) {
            return;
        }
        status = icd_dos_time_unpack(link, value, &time);
        if (status != ICD_OK) {
            (void)refuse_status(talk, status);
            return;
        }
        put_ok(talk);
        put_key_number(&talk->out, "year", time.year);
        put_key_number(&talk->out, "month", time.month);
        put_key_number(&talk->out, "day", time.day);
        put_key_number(&talk->out, "hour", time.hour);
        put_key_number(&talk->out, "minute", time.minute);
        put_key_number(&talk->out, "second", time.second);
        json_put_text(&talk->out, icd_dos_time_wrong(&time) == NULL ? ",\"valid\":true" : ",\"valid\":false");
        return;
    }
    for (i = 0; i < 6u; i++) {
        if (!ask_number(talk, 0, names[i], 0, 9999, REQUIRED, &parts[i])) {
            return;
        }
    }
    time.year = (uint16_t)parts[0];
    time.month = (uint16_t)parts[1];
    time.day = (uint16_t)parts[2];
    time.hour = (uint16_t)parts[3];
    time.minute = (uint16_t)parts[4];
    time.second = (uint16_t)parts[5];
    status = icd_dos_time_pack(link, &time, &value, &wrong);
    if (status == ICD_ERROR_RANGE) {
        (void)refuse_field(talk, "range", wrong, strlen(wrong));
    } else if (status != ICD_OK) {
        (void)refuse_status(talk, status);
    } else {
        put_ok(talk);
        put_key_number(&talk->out, "value", value);
    }
}

/* ---- hole maps and the index file -------------------------------------------------------------------------------------- */

static void put_missing(talk_t *talk, const icd_link_t *link, const uint8_t *map, uint32_t packets)
{
    uint32_t i;
    bool first = true;
    json_put_text(&talk->out, ",\"missing\":[");
    for (i = link->files->first_packet; i < link->files->first_packet + packets; i++) {
        if (!icd_hole_map_get(link, map, i)) {
            json_put(&talk->out, ",", first ? 0u : 1u);
            json_put_unsigned(&talk->out, i);
            first = false;
        }
    }
    json_put_text(&talk->out, "]");
}

static void missing(talk_t *talk, const icd_link_t *link, uint32_t packets)
{
    octets_t map;
    if (!ask_octets(talk, 0, "bytes", &map)) {
        return;
    }
    if (link->hole_map == NULL || link->files == NULL) {
        (void)refuse(talk, "unsupported");
    } else if (map.length != link->hole_map->bytes) {
        (void)refuse_length(talk, "length", link->hole_map->bytes, map.length);
    } else if (packets > link->hole_map->bytes * 8u) {
        (void)refuse(talk, "range");
    } else {
        put_ok(talk);
        put_missing(talk, link, map.data, packets);
    }
}

void hole_map(talk_t *talk, const icd_link_t *link)
{
    uint32_t packets;
    size_t list, at, i, piece;
    uint8_t *map;
    icd_status_t status;
    if (!ask_number(talk, 0, "packets", 0, MOST_NUMBER, REQUIRED, &packets)) {
        return;
    }
    if (json_find(&talk->row, 0, "bytes") != 0u) {
        missing(talk, link, packets);
        return;
    }
    if (!ask_rows(talk, 0, "received", &list)) {
        return;
    }
    for (i = 0, at = list + 1u; i < talk->row.values[list].count; i++, at = talk->row.values[at].after) {
        if (talk->row.values[at].type != JSON_INTEGER) {
            (void)refuse_request(talk, "received holds numbers");
            return;
        }
    }
    map = (uint8_t *)memory(link->hole_map != NULL ? link->hole_map->bytes : 0u);
    status = icd_hole_map_init(link, map, packets);
    for (i = 0, at = list + 1u; status == ICD_OK && i < talk->row.values[list].count; i++, at++) {
        const json_value_t *value = &talk->row.values[at];
        const bool fits = !value->too_large && value->magnitude <= MOST_NUMBER &&
            (!value->negative || value->magnitude == 0u);
        status = fits ? icd_hole_map_set(link, map, packets, (uint32_t)value->magnitude) : ICD_ERROR_RANGE;
    }
    if (status != ICD_OK) {
        (void)refuse_status(talk, status);
        return;
    }
    put_ok(talk);
    put_key_octets(&talk->out, "bytes", map, link->hole_map->bytes);
    json_put_text(&talk->out, ",\"messages\":[");
    piece = link->hole_map->message_bytes;
    for (i = 0; i < link->hole_map->bytes; i += piece) {
        json_put(&talk->out, ",", i != 0u ? 1u : 0u);
        put_octets(&talk->out, map + i, piece < link->hole_map->bytes - i ? piece : link->hole_map->bytes - i);
    }
    json_put_text(&talk->out, "]");
    put_missing(talk, link, map, packets);
}

void index_decode(talk_t *talk, const icd_link_t *link)
{
    octets_t octets;
    icd_index_entry_t entry;
    size_t at, size;
    if (!ask_octets(talk, 0, "bytes", &octets)) {
        return;
    }
    if (link->index == NULL) {
        (void)refuse(talk, "unsupported");
        return;
    }
    size = link->index->entry_bytes;
    put_ok(talk);
    json_put_text(&talk->out, ",\"entries\":[");
    for (at = 0; octets.length - at >= size; at += size) {
        if (icd_index_entry_decode(link, octets.data + at, size, &entry) != ICD_OK) {
            break;
        }
        json_put_text(&talk->out, at != 0u ? ",{\"type\":" : "{\"type\":");
        json_put_unsigned(&talk->out, entry.type);
        put_key_number(&talk->out, "counter", entry.counter);
        put_key_number(&talk->out, "checksum", entry.checksum);
        put_key_number(&talk->out, "size", entry.size);
        put_key_number(&talk->out, "time", entry.time);
        put_key_octets(&talk->out, "meta", entry.meta, entry.meta_length);
        json_put_text(&talk->out, "}");
    }
    json_put_text(&talk->out, "]");
    put_key_number(&talk->out, "truncated", (int64_t)(octets.length - at));
}

static bool ask_entry(talk_t *talk, size_t object, icd_index_entry_t *entry)
{
    octets_t meta;
    if (!ask_number(talk, object, "type", 0, MOST_NUMBER, REQUIRED, &entry->type) ||
        !ask_number(talk, object, "counter", 0, MOST_NUMBER, REQUIRED, &entry->counter) ||
        !ask_number(talk, object, "checksum", 0, MOST_NUMBER, REQUIRED, &entry->checksum) ||
        !ask_number(talk, object, "size", 0, MOST_NUMBER, REQUIRED, &entry->size) ||
        !ask_number(talk, object, "time", 0, MOST_NUMBER, REQUIRED, &entry->time) ||
        !ask_octets(talk, object, "meta", &meta)) {
        return false;
    }
    entry->meta = meta.data;
    entry->meta_length = meta.length;
    return true;
}

void index_encode(talk_t *talk, const icd_link_t *link)
{
    size_t list, at, i, count, size;
    icd_index_entry_t *entries;
    uint8_t *file;
    if (!ask_mappings(talk, 0, "entries", &list)) {
        return;
    }
    count = talk->row.values[list].count;
    entries = (icd_index_entry_t *)memory(count * sizeof *entries);
    for (i = 0, at = list + 1u; i < count; i++, at = talk->row.values[at].after) {
        if (!ask_entry(talk, at, &entries[i])) {
            return;
        }
    }
    if (link->index == NULL) {
        (void)refuse(talk, "unsupported");
        return;
    }
    size = link->index->entry_bytes;
    file = (uint8_t *)memory(count * size);
    for (i = 0; i < count; i++) {
        const icd_status_t status = icd_index_entry_encode(link, &entries[i], file + (i * size), size);
        if (status == ICD_ERROR_LENGTH) {
            (void)refuse_length(talk, "length", link->index->meta.bytes, entries[i].meta_length);
            return;
        }
        if (status != ICD_OK) {
            (void)refuse_status(talk, status);
            return;
        }
    }
    put_ok(talk);
    put_key_octets(&talk->out, "bytes", file, count * size);
}

void identify(talk_t *talk, const icd_link_t *link)
{
    octets_t octets;
    icd_identity_t identity;
    icd_status_t status;
    if (!ask_octets(talk, 0, "bytes", &octets)) {
        return;
    }
    status = icd_identify(link, octets.data, octets.length, &identity);
    if (status == ICD_ERROR_LENGTH) {
        (void)refuse_length(talk, "length", link->identification->length, octets.length);
    } else if (status != ICD_OK) {
        (void)refuse_status(talk, status);
    } else {
        put_ok(talk);
        put_key_number(&talk->out, "node_type", identity.node_type);
        put_key_number(&talk->out, "interface_version", identity.interface_version);
        json_put_text(&talk->out, identity.matches ? ",\"matches\":true" : ",\"matches\":false");
    }
}
