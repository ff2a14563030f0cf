#ifndef ICDGEN_WIRE_STREAM_FORM_H
#define ICDGEN_WIRE_STREAM_FORM_H

#include "../icdgen.h"
#include "forms.h"

/* ---- framing of a link: header and trailer fields with roles ----------------------------------------------------- */

/** How messages are delimited. ICD_DELIMITED_BY_DATAGRAM: each datagram is one. */
typedef enum {
    ICD_DELIMITED_BY_LENGTH = 0,
    ICD_DELIMITED_BY_SLIP = 1,
    ICD_DELIMITED_BY_COBS = 2,
    ICD_DELIMITED_BY_HDLC = 3,
    ICD_DELIMITED_BY_DATAGRAM = 4,
    ICD_DELIMITED_BY_ESCAPE = 5
} icd_delimiter_t;

/** The escape byte that delimits packets, and the bytes that follow it. */
typedef struct {
    uint8_t escape;
    uint8_t start; /**< Begins a packet, if `has_start`; otherwise, the first byte of the packet does. */
    uint8_t end;
    uint8_t data; /**< Stands for the escape byte itself. */
    bool has_start;
    bool ignores_other; /**< Within a packet: whether an escape byte and any other byte are skipped. */
} icd_escaping_t;

/** Role of a header or trailer field. The sender chooses the values of the first ICD_HEADER_VALUES roles. */
typedef enum {
    ICD_FIELD_SEQUENCE = 0,
    ICD_FIELD_SOURCE = 1,
    ICD_FIELD_DESTINATION = 2,
    ICD_FIELD_TYPE = 3,
    ICD_FIELD_FLAGS = 4,
    ICD_FIELD_TIME = 5,
    ICD_FIELD_STATUS = 6,
    ICD_FIELD_REASON = 7,
    ICD_FIELD_CONSTANT = 8,
    ICD_FIELD_ID = 9,
    ICD_FIELD_LENGTH = 10,
    ICD_FIELD_CHECKSUM = 11,
    ICD_FIELD_RESPONSE_LENGTH = 12
} icd_field_role_t;

#define ICD_HEADER_VALUES 8 /**< Number of roles whose values the sender chooses. */

/** Values of the header and trailer fields that the sender chooses, indexed by icd_field_role_t. */
typedef struct {
    uint32_t of[ICD_HEADER_VALUES];
} icd_header_values_t;

/** A value that stands for the default of the packet format, in fields of less than 32 bits. */
#define ICD_HEADER_DEFAULT UINT32_C(0xFFFFFFFF)

/**
 * A header or trailer field. The number in the `size` bytes from byte `at` on is shifted right by `shift` and masked to
 * `bits` bits.
 */
typedef struct {
    icd_field_role_t role;
    bool in_trailer;
    uint8_t at;
    uint8_t size;
    uint8_t shift;
    uint8_t bits;
    bool little;
    /**
     * Constant or default value in telecommands and in telemetry; of a part of the id, the number of lower bits; of a
     * length, what is added to the number of data bytes, modulo 2^32, and the number of bytes that it counts as one.
     */
    uint32_t values[2];
} icd_packet_field_t;

/** The checksum of a packet format. */
typedef struct {
    const icd_checksum_algorithm_t *algorithm;
    uint8_t covered_from;    /**< First byte of the header that it covers. */
    uint8_t covered_trailer; /**< Number of bytes of the trailer that it covers. */
    bool is_seeded;          /**< Whether the seed of the message is appended as the last byte that it covers. */
} icd_check_form_t;

/** What the packets of a format contain. */
typedef enum {
    ICD_PACKET_MESSAGE = 0,
    ICD_PACKET_REQUEST = 1,  /**< The id of telemetry that is requested, and reserved bytes. */
    ICD_PACKET_NOTHING = 2,  /**< No message, but reserved bytes; the packet itself is a response. */
    ICD_PACKET_REQUESTED = 3 /**< Telemetry that was requested. Only the request has its id. */
} icd_packet_content_t;

/** A packet format: header, data and trailer. */
typedef struct {
    uint32_t ids[2]; /**< Without an id field: id of its only telecommand and telemetry; otherwise 0. */
    const icd_packet_field_t *fields;
    const icd_check_form_t *check;
    uint8_t field_count;
    uint8_t header_bytes;
    uint8_t trailer_bytes;
    icd_packet_content_t content;
    bool is_sent[2];   /**< Whether there are such packets in the direction of telecommands, and of telemetry. */
    uint16_t reserved; /**< Number of data bytes of packets without a message. They are zero. */
} icd_packet_form_t;

/** What a response means for its telecommand. */
typedef enum {
    ICD_VERDICT_ACK = 0,      /**< The telecommand was accepted. */
    ICD_VERDICT_REPLY = 1,    /**< This is the telemetry that the telecommand requested. */
    ICD_VERDICT_NAK = 2,      /**< The telecommand was refused. */
    ICD_VERDICT_BUSY = 3,     /**< The device is busy. */
    ICD_VERDICT_PROGRESS = 4, /**< The telecommand is still being executed. */
    ICD_VERDICT_AGAIN = 5     /**< The telecommand was damaged on the line, and is sent again. */
} icd_verdict_t;

/**
 * Place of a number in a message: its id, as 4 bytes with the most significant first, followed by its data. The number
 * in the `size` bytes from byte `at` on is shifted right by `shift` and masked to `bits` bits. Bytes that the message
 * does not have are 0.
 */
typedef struct {
    uint32_t at;
    uint8_t size;
    uint8_t shift;
    uint8_t bits;
    bool little;
} icd_number_place_t;

/** A number of a response that repeats number `source` of the telecommand. */
typedef struct {
    const icd_number_place_t *place; /**< Equal places of a link are the same object. */
    uint8_t source;
} icd_echo_t;

/** What a value of a status means. */
typedef struct {
    uint32_t value;
    icd_verdict_t verdict;
} icd_meaning_t;

/* Parts that responses can have. */
#define ICDGEN_RESPONSE_ECHO 1u        /* repeats numbers of the telecommand */
#define ICDGEN_RESPONSE_HEADER_ECHO 2u /* repeats numbers of its header */
#define ICDGEN_RESPONSE_STATUS 4u
#define ICDGEN_RESPONSE_REASON 8u
#define ICDGEN_RESPONSE_DETAIL 16u

/**
 * Telemetry, or a packet without a message, that can end, refuse, defer or prolong a telecommand. Places that the ICD
 * does not have are NULL.
 */
typedef struct {
    uint32_t source;       /**< Id of the telemetry, or index of the packet. */
    icd_verdict_t verdict; /**< With a status: the meaning of all values that are not in `meanings`. */
    uint8_t echo_count;
    bool is_packet;   /**< The places in a packet count from 4 bytes before its first byte, as if the id stood there. */
    uint8_t verdicts; /**< All that it can mean, as a mask; bit n: verdict n of icd_verdict_t. */
    uint16_t meaning_count;
    const icd_echo_t *echoes;
    const icd_meaning_t *meanings;
    const icd_number_place_t *status;
    const icd_number_place_t *reason; /**< Reason of a refusal. */
    const icd_number_place_t *detail; /**< A number that says more about a refusal. */
} icd_response_t;

/** Telemetry that a client requests until it has the right echo and the number `until` is not 0. */
typedef struct {
    uint32_t telemetry;
    icd_number_place_t until;
} icd_outcome_poll_t;

#define ICD_MOST_SOURCES 4u /**< Largest number of numbers of a telecommand that its responses repeat. */

/** The possible responses to a telecommand or to a request of telemetry, except for the requested telemetry. */
typedef struct {
    /**
     * Numbers of the telecommand that responses repeat. The last `header_count` of them are in the header of its
     * packet, and count as in a packet that responds.
     */
    const icd_number_place_t *sources;
    const icd_response_t *responses;
    uint8_t source_count;
    uint8_t header_count;
    uint8_t response_count;
    bool is_request;                /**< Of a request of telemetry: the requested telemetry precedes `responses`. */
    uint32_t timeout;               /**< In milliseconds; 0: the time-out of the client. */
    const icd_outcome_poll_t *poll; /**< I2C: what is requested until it is the response; otherwise NULL. */
} icd_exchange_t;

/** The exchanges on UART, I2C or CAN. */
typedef struct {
    const icd_exchange_t *command; /**< Of telecommands with ICD_ACKNOWLEDGED; NULL if the bus has no acknowledge. */
    const icd_exchange_t *request; /**< Of requests of telemetry. */
} icd_bus_exchanges_t;

#define ICD_STREAM_CUTS_ZEROS 1u /**< Trailing zeros of the data are not sent, except for the first byte. */
#define ICD_STREAM_REPEATS 2u    /**< Of a telecommand: it may be sent again after a time-out. */
#define ICD_STREAM_REQUESTS                                                                                            \
    4u /**< Of a telecommand: it requests telemetry `requested` if it is sent as `least` zeros. */
#define ICD_STREAM_REQUESTED 8u /**< Of telemetry: the packet of icd_telemetry_request_t requests it. */
#define ICD_STREAM_NAMELESS 16u /**< Of telemetry: it comes in a packet (ICD_PACKET_REQUESTED) without its id. */

/** A message: id, shortest and longest data length in bytes, flags, seed, and index of the packet format. */
typedef struct {
    uint32_t id;
    uint16_t least;
    uint16_t most;
    uint8_t flags;
    uint8_t seed;
    uint8_t packet;
    uint32_t requested;             /**< Of a telecommand: id of the telemetry that it requests. */
    const icd_exchange_t *exchange; /**< Of a telecommand: NULL if nothing responds to it. */
} icd_stream_row_t;

/** The request of telemetry by a packet with its id and `reserved` bytes. */
typedef struct {
    const icd_exchange_t *exchange;
    uint8_t packet; /**< Index of the packet format. */
} icd_telemetry_request_t;

/** Framing of messages in a stream of bytes or in packets. */
typedef struct {
    icd_delimiter_t delimited_by;
    bool per_id; /**< Whether each id has its own sequence counter. */
    uint8_t packet_count;
    int16_t around[2];                /**< Most bytes of header and trailer in each direction; -1 without packets. */
    const icd_packet_form_t *packets; /**< If two formats fit, the first is received. */
    const icd_stream_row_t *rows[2];  /**< Telecommands and telemetry, in ascending order of the ids. */
    uint16_t row_counts[2];
    uint16_t confirming_count;
    const uint32_t *confirming; /**< Ids of telemetry that only responds to telecommands, and is not requested. */
    const icd_telemetry_request_t *request; /**< NULL if only telecommands request telemetry. */
    const icd_escaping_t *escaping;         /**< NULL unless escape characters delimit packets. */
} icd_stream_form_t;

#endif /* ICDGEN_WIRE_STREAM_FORM_H */
