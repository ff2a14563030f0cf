#ifndef ICDGEN_WIRE_LINK_C
#define ICDGEN_WIRE_LINK_C

#include "link.h"

static inline bool icdgen_same_name(const char *one, const char *other)
{
    while (*one != '\0' && *one == *other) {
        ++one;
        ++other;
    }
    return *one == *other;
}

ICDGEN_API bool icd_has_messages_of(const icd_link_t *link, const char *node)
{
    for (size_t i = 0; i < link->node_count; ++i) {
        if (icdgen_same_name(link->nodes[i], node)) {
            return true;
        }
    }
    return false;
}

ICDGEN_API const icd_message_t *icd_find_message(const icd_link_t *link, icd_direction_t direction, uint32_t id)
{
    const icd_message_t *const table = direction == ICD_TELECOMMAND ? link->telecommands : link->telemetry;
    size_t low = 0, high = direction == ICD_TELECOMMAND ? link->telecommand_count : link->telemetry_count;
    while (low < high) {
        const size_t middle = (low + high) / 2u;
        if (table[middle].id == id) {
            return &table[middle];
        }
        if (table[middle].id < id) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return NULL;
}

/* Return whether a set of buses contains a bus. */
static inline bool icdgen_on_bus(uint8_t buses, icd_bus_t bus)
{
    return ((ICDGEN_U32(buses) >> ICDGEN_U32(bus)) & 1u) != 0u;
}

/* Read a number of several bytes in the byte order of the node. */
static inline uint32_t icdgen_number(const icd_link_t *link, const uint8_t *bytes, size_t count)
{
    uint32_t number = 0;
    for (size_t i = 0; i < count; ++i) {
        number = (number << 8) | bytes[link->little ? count - 1u - i : i];
    }
    return number;
}

/* Write a number of several bytes. Return ICD_ERROR_RANGE if it does not fit. */
static inline icd_status_t icdgen_put_number(const icd_link_t *link, uint8_t *bytes, size_t count, uint32_t number)
{
    for (size_t i = 0; i < count; ++i) {
        bytes[link->little ? i : count - 1u - i] = ICDGEN_U8(number & 0xFFu);
        number >>= 8;
    }
    return number == 0u ? ICD_OK : ICD_ERROR_RANGE;
}

static inline const icd_place_t *icdgen_place(const icd_report_t *report, icd_role_t role)
{
    for (size_t i = 0; i < report->place_count; ++i) {
        if (report->places[i].role == role) {
            return &report->places[i];
        }
    }
    return NULL;
}

/* Return the raw value of the field with a role; 0 if the frame has no such field. */
static inline uint32_t icdgen_get(
    const icd_link_t *link, const icd_report_t *report, const uint8_t *frame, icd_role_t role)
{
    const icd_place_t *const place = icdgen_place(report, role);
    uint32_t value = 0;
    unsigned below = 0;
    unsigned at = place != NULL ? place->at : 0u;
    const unsigned end = place != NULL ? at + place->bits : 0u;
    while (at < end) {
        const unsigned first = at % 8u;
        const unsigned count = 8u - first < end - at ? 8u - first : end - at;
        const unsigned shift = link->msb0 ? 8u - first - count : first;
        const uint32_t run = (ICDGEN_U32(frame[at / 8u]) >> shift) & ((1u << count) - 1u);
        value = link->little ? value | (run << below) : (value << count) | run;
        below += count;
        at += count;
    }
    return value;
}

ICDGEN_API icd_status_t
icd_identify(const icd_link_t *link, const uint8_t *frame, size_t length, icd_identity_t *identity)
{
    const icd_report_t *const report = link->identification;
    if (report == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (length != report->length) {
        return ICD_ERROR_LENGTH;
    }
    identity->node_type = icdgen_get(link, report, frame, ICD_ROLE_NODE_TYPE);
    identity->interface_version = icdgen_get(link, report, frame, ICD_ROLE_INTERFACE_VERSION);
    identity->matches = (link->node_type < 0 || ICDGEN_U32(link->node_type) == identity->node_type) &&
        (link->interface_version < 0 || ICDGEN_U32(link->interface_version) == identity->interface_version);
    return ICD_OK;
}

#endif /* ICDGEN_WIRE_LINK_C */
