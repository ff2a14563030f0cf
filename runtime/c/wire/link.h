#ifndef ICDGEN_WIRE_LINK_H
#define ICDGEN_WIRE_LINK_H

#include "../icdgen.h"
#include "forms.h"
#include "procedure_forms.h"

/** How a client waits and tries again, in milliseconds. */
typedef struct {
    /** How long a reply may take, in milliseconds. */
    uint32_t reply_timeout;
    /** How often a request is sent again. */
    uint8_t retries;
    /** Time between two polls for an acknowledge, in milliseconds. */
    uint32_t poll_interval;
    /** How long a telecommand may take to be processed, in milliseconds. */
    uint32_t poll_timeout;
} icd_client_settings_t;

/** Everything about the protocol of a node. What the ICD does not describe is NULL. */
typedef struct {
    const char *const *nodes; /**< Whose messages it has: its own, then those of the nodes that it includes. */
    uint16_t node_count;
    bool little; /**< Byte order of numbers. */
    bool msb0;   /**< Bit 0 of a byte is the most significant one. */
    uint8_t telemetry_first, telemetry_last;
    const icd_message_t *telecommands; /**< By rising id. */
    const icd_message_t *telemetry;    /**< By rising id. */
    uint16_t telecommand_count, telemetry_count;
    uint32_t longest_telecommand; /**< Bytes with id and checksum, and so the next two. */
    uint32_t longest_reply;
    uint32_t longest;
    uint32_t longest_data; /**< Without. */
    int32_t node_type;     /**< -1 if the ICD has none. */
    int32_t interface_version;
    icd_client_settings_t client;
    const icd_error_code_t *errors;
    uint8_t error_count;
    uint32_t no_error;
    const icd_framing_t *framing;
    const icd_acknowledge_t *acknowledge;
    int16_t i2c_address;      /**< Of 7 bits, -1 if the ICD has none. */
    int32_t boot_ms;          /**< How long the boot program waits, -1 if the ICD does not say. */
    const icd_step_t *polled; /**< The frame that tells what became of a telecommand. */
    const icd_can_form_t *can;
    const icd_checksum_form_t *checksum;
    const icd_crc_form_t *crc16;
    const icd_log_mask_form_t *log_mask;
    const icd_log_file_form_t *log_file;
    const icd_log_message_form_t *log_message;
    const icd_time_form_t *time;
    const icd_index_form_t *index;
    const icd_hole_map_form_t *hole_map;
    const icd_files_form_t *files;
    const icd_list_form_t *list;
    const icd_download_form_t *download;
    const icd_upload_form_t *upload;
    const icd_erase_form_t *erase;
    const icd_erase_form_t *format;
    const icd_operation_form_t *program_copy;
    const icd_operation_form_t *program_information;
    const icd_step_t *identification;
} icd_link_t;

static inline bool icdgen_same_name(const char *one, const char *other)
{
    while (*one != '\0' && *one == *other) {
        ++one;
        ++other;
    }
    return *one == *other;
}

/** Whether the node has the messages of that one, which is so of itself and of those that it includes. */
static inline bool icd_has_messages_of(const icd_link_t *link, const char *node)
{
    for (size_t i = 0; i < link->node_count; ++i) {
        if (icdgen_same_name(link->nodes[i], node)) {
            return true;
        }
    }
    return false;
}

/** The message of an id; NULL if the node has none. */
static inline const icd_message_t *icd_find_message(const icd_link_t *link, icd_direction_t direction, unsigned id)
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

/* A number of several bytes in the node's byte order. */
static inline uint32_t icdgen_number(const icd_link_t *link, const uint8_t *bytes, size_t count)
{
    uint32_t number = 0;
    for (size_t i = 0; i < count; ++i) {
        number = (number << 8) | bytes[link->little ? count - 1u - i : i];
    }
    return number;
}

/* The reverse; ICD_ERROR_RANGE if it does not fit. */
static inline icd_status_t icdgen_put_number(const icd_link_t *link, uint8_t *bytes, size_t count, uint32_t number)
{
    for (size_t i = 0; i < count; ++i) {
        bytes[link->little ? i : count - 1u - i] = ICDGEN_U8(number & 0xFFu);
        number >>= 8;
    }
    return number == 0u ? ICD_OK : ICD_ERROR_RANGE;
}

static inline const icd_place_t *icdgen_place(const icd_step_t *step, icd_role_t role)
{
    for (size_t i = 0; i < step->place_count; ++i) {
        if (step->places[i].role == role) {
            return &step->places[i];
        }
    }
    return NULL;
}

/* The raw value of a role in a frame, 0 if the frame has no such role. */
static inline uint32_t icdgen_get(const icd_link_t *link, const icd_step_t *step, const uint8_t *frame, icd_role_t role)
{
    const icd_place_t *const place = icdgen_place(step, role);
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

/* Puts the raw value of a role into a frame in which its bits are 0. */
static inline void icdgen_put(
    const icd_link_t *link, const icd_step_t *step, uint8_t *frame, icd_role_t role, uint32_t value)
{
    const icd_place_t *const place = icdgen_place(step, role);
    unsigned at = place != NULL ? place->at : 0u;
    const unsigned end = place != NULL ? at + place->bits : 0u;
    unsigned below = link->little ? 0u : end - at;
    while (at < end) {
        const unsigned first = at % 8u;
        const unsigned count = 8u - first < end - at ? 8u - first : end - at;
        const unsigned shift = link->msb0 ? 8u - first - count : first;
        below -= link->little ? 0u : count;
        frame[at / 8u] = ICDGEN_U8(frame[at / 8u] | (((value >> below) & ((1u << count) - 1u)) << shift));
        below += link->little ? count : 0u;
        at += count;
    }
}

/* Whether a number is one of those that are allowed, of which NULL stands for all. */
static inline bool icdgen_allowed(const uint8_t *allowed, size_t count, uint8_t number)
{
    bool found = allowed == NULL;
    for (size_t i = 0; !found && i < count; ++i) {
        found = allowed[i] == number;
    }
    return found;
}

/** Who the node is. */
typedef struct {
    uint32_t node_type;
    uint32_t interface_version;
    bool matches; /**< Whether both are those of the ICD, as far as it has them. */
} icd_identity_t;

/** What an identification frame tells, to be called before anything else is believed. */
static inline icd_status_t icd_identify(
    const icd_link_t *link, const uint8_t *frame, size_t length, icd_identity_t *identity)
{
    const icd_step_t *const step = link->identification;
    if (step == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (length != step->length) {
        return ICD_ERROR_LENGTH;
    }
    identity->node_type = icdgen_get(link, step, frame, ICD_ROLE_NODE_TYPE);
    identity->interface_version = icdgen_get(link, step, frame, ICD_ROLE_INTERFACE_VERSION);
    identity->matches = (link->node_type < 0 || ICDGEN_U32(link->node_type) == identity->node_type) &&
        (link->interface_version < 0 || ICDGEN_U32(link->interface_version) == identity->interface_version);
    return ICD_OK;
}

#endif /* ICDGEN_WIRE_LINK_H */
