#ifndef ICDGEN_WIRE_LINK_H
#define ICDGEN_WIRE_LINK_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "procedure_forms.h"
#include "stream_form.h"

/** How a client waits and tries again, in milliseconds. */
typedef struct {
    /** Time-out of a reply, in milliseconds. */
    uint32_t reply_timeout;
    /** Number of retries of a request. */
    uint8_t retries;
    /** Time between two polls for an acknowledge, in milliseconds. */
    uint32_t poll_interval;
    /** Longest processing time of a telecommand, in milliseconds. */
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
    bool i2c_repeated_start;  /**< A read may follow its write without a stop; else there must be one. */
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
    const icd_stream_form_t *stream; /**< Then ids have up to 32 bits, and nothing else of the link is described. */
} icd_link_t;

/** Whether the node has the messages of that one, which is so of itself and of those that it includes. */
ICDGEN_API bool icd_has_messages_of(const icd_link_t *link, const char *node);

/** The message of an id; NULL if the node has none. */
ICDGEN_API const icd_message_t *icd_find_message(const icd_link_t *link, icd_direction_t direction, unsigned id);

/** Who the node is. */
typedef struct {
    uint32_t node_type;
    uint32_t interface_version;
    bool matches; /**< Whether both are those of the ICD, as far as it has them. */
} icd_identity_t;

/** What an identification frame tells, to be called before anything else is believed. */
ICDGEN_API icd_status_t
icd_identify(const icd_link_t *link, const uint8_t *frame, size_t length, icd_identity_t *identity);

#endif /* ICDGEN_WIRE_LINK_H */
