#ifndef ICDGEN_WIRE_LINK_H
#define ICDGEN_WIRE_LINK_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "stream_form.h"

/** Largest number of requests whose responses are awaited or may still arrive late. A program may define less. */
#ifndef ICDGEN_MOST_AWAITED
#define ICDGEN_MOST_AWAITED 8u
#endif

/** Timeouts (in milliseconds) and retries of a client. */
typedef struct {
    /** Time-out of a reply, in milliseconds. */
    uint32_t reply_timeout;
    /** Number of retries of a request. */
    uint8_t retries;
    /** Time between two polls for an acknowledge, in milliseconds. */
    uint32_t poll_interval;
    /** Longest processing time of a telecommand, in milliseconds. */
    uint32_t poll_timeout;
    /** Time after a time-out in which a response can still come, in milliseconds. */
    uint32_t late;
    /** Pause before a request is sent to a busy device again, in milliseconds. */
    uint32_t busy_pause;
    /** Shortest time between two transmissions, in milliseconds. */
    uint32_t gap;
    /** Number of requests that the device handles at a time. */
    uint8_t in_flight;
    /** Longest time by which reports of progress extend a time-out, in milliseconds. */
    uint32_t progress_for;
} icd_client_settings_t;

/** Description of the protocol of a node. Parts that the ICD does not describe are NULL. */
typedef struct {
    const char *const *nodes; /**< Names of the node and of the nodes that it includes. */
    uint16_t node_count;
    bool little; /**< Byte order of numbers. */
    bool msb0;   /**< Bit 0 of a byte is the most significant one. */
    uint8_t telemetry_first, telemetry_last;
    uint16_t reason_count;
    uint8_t unsolicited_count;
    uint16_t telecommand_count, telemetry_count;
    const icd_message_t *telecommands; /**< In ascending order of the ids. */
    const icd_message_t *telemetry;    /**< In ascending order of the ids. */
    uint32_t longest_telecommand; /**< Largest size in bytes, with id and checksum; on framed links only of the data. */
    uint32_t longest_reply;
    uint32_t longest;
    uint32_t longest_data;           /**< Largest size in bytes, without id and checksum. */
    uint32_t received_bytes;         /**< Buffer size in bytes of a client for what it receives. */
    const icd_stream_form_t *stream; /**< Framing. If present, ids have up to 32 bits and the other parts are NULL. */
    const icd_bus_exchanges_t *exchanges[ICD_BUSES]; /**< By icd_bus_t; NULL: the node is not on the bus. */
    const icd_checksum_form_t *checksum;
    const uint32_t *reasons; /**< Codes of refusals on UART and I2C that the enumeration of the codes has. */
    const icd_framing_t *framing;
    uint16_t acknowledge_bytes;           /**< Length of the acknowledge on the UART; 0 without one. */
    const icd_unsolicited_t *unsolicited; /**< UART: telemetry that arrives unsolicited. */
    const icd_log_message_form_t *log_message;
    const icd_can_form_t *can;
    icd_client_settings_t client;
    int32_t node_type; /**< -1 if the ICD has none. */
    int32_t interface_version;
    int16_t i2c_address;     /**< 7-bit address, -1 if the ICD has none. */
    bool i2c_repeated_start; /**< Whether a read may follow its write without a stop. */
    int32_t boot_ms;         /**< Waiting time of the boot program in ms, -1 if unknown. */
    const icd_log_mask_form_t *log_mask;
    const icd_log_file_form_t *log_file;
    const icd_time_form_t *time;
    const icd_index_form_t *index;
    const icd_report_t *identification;
} icd_link_t;

/** Return whether `node` is the node of this link or a node that it includes. */
ICDGEN_API bool icd_has_messages_of(const icd_link_t *link, const char *node);

/** Return the message with this id; NULL if the node has none. */
ICDGEN_API const icd_message_t *icd_find_message(const icd_link_t *link, icd_direction_t direction, uint32_t id);

/** Identity of a node. */
typedef struct {
    uint32_t node_type;
    uint32_t interface_version;
    bool matches; /**< Whether both equal the values of the ICD, if it has them. */
} icd_identity_t;

/** Decode an identification frame. Call this first and check `matches` before you use other messages of the node. */
ICDGEN_API icd_status_t
icd_identify(const icd_link_t *link, const uint8_t *frame, size_t length, icd_identity_t *identity);

#endif /* ICDGEN_WIRE_LINK_H */
