#ifndef ICDGEN_WIRE_FORMS_H
#define ICDGEN_WIRE_FORMS_H

#include "../icdgen.h"

/* ---- description of the protocol of a node ----------------------------------------------------------------------- */

/* Mask with the bit of an enumerator. */
#define ICDGEN_BIT(member) (1u << ICDGEN_U32(member))

typedef enum { ICD_BUS_UART = 0, ICD_BUS_I2C = 1, ICD_BUS_CAN = 2 } icd_bus_t;

#define ICD_BUSES 3u

typedef enum { ICD_TELECOMMAND = 0, ICD_TELEMETRY = 1 } icd_direction_t;

/** Flags of a telecommand. */
#define ICD_ACKNOWLEDGED 1u  /**< The node acknowledges it. */
#define ICD_EXPECTS_RESET 2u /**< The node restarts instead. */
#define ICD_SETTING 4u       /**< It sets a configuration that can be read back, so it may be sent again. */

/** A message with its id in one direction. */
typedef struct {
    uint8_t id;
    uint8_t flags;
    uint16_t length;
} icd_message_t;

/** How messages are delimited on the UART; the escape byte comes before each of the other three. */
typedef struct {
    /** The escape byte. */
    uint8_t escape;
    /** Follows the escape byte at the beginning of a message. */
    uint8_t start;
    /** Follows the escape byte at the end of a message. */
    uint8_t end;
    /** Follows the escape byte if the escape byte itself is data. */
    uint8_t escaped;
    /** Whether the id is escaped like the data. */
    bool escapes_id;
    /** Whether an escape byte and an unknown byte are skipped; otherwise it is an error. */
    bool ignores_other;
} icd_framing_t;

/** Telemetry that arrives unsolicited on the UART: id at the head of the message, and what it contains. */
typedef struct {
    uint8_t id;
    uint8_t telemetry;
    uint16_t length; /**< Of the telemetry. */
} icd_unsolicited_t;

/* A compiler that optimizes for size leaves out the lookup tables of CRCs. */
#if defined(__OPTIMIZE_SIZE__) && !defined(ICDGEN_TABLES) && !defined(ICDGEN_NO_TABLES)
#define ICDGEN_NO_TABLES
#endif

/* Lookup table of a CRC; NULL if tables are disabled. */
#ifdef ICDGEN_NO_TABLES
#define ICDGEN_TABLE(table) NULL
#else
#define ICDGEN_TABLE(table) (table)
#endif

/* Number of messages in a table, whose last row is not one. */
#define ICDGEN_ROWS(table) ICDGEN_U16((sizeof(table) / sizeof((table)[0])) - 1u)

/* Optional parts. A part that is left out is treated as if the ICD did not describe it. */
#ifdef ICDGEN_NO_FILES
#define ICDGEN_OF_FILES(part) NULL
#else
#define ICDGEN_OF_FILES(part) (part)
#endif
#ifdef ICDGEN_NO_LOGS
#define ICDGEN_OF_LOGS(part) NULL
#else
#define ICDGEN_OF_LOGS(part) (part)
#endif

/** Parameters of a CRC in the notation of the usual catalogues. */
typedef struct {
    /** Bits of the checksum. */
    uint32_t width;
    /** Generator polynomial, most significant bit first, without the leading term. */
    uint32_t polynomial;
    /** Initial value of the register. */
    uint32_t init;
    /** Whether each byte enters least significant bit first. */
    bool reflect_in;
    /** Whether the bits of the register are reversed at the end. */
    bool reflect_out;
    /** Final XOR value: combined with the register at the end. */
    uint32_t xor_out;
    /** Whether `empty` is known. */
    bool has_empty;
    /** Checksum of no bytes, if it is not the result of the algorithm. */
    uint32_t empty;
    const uint8_t *table8;   /**< For a width of up to 8 bits. */
    const uint16_t *table16; /**< For a greater width. Both NULL: computed without a table. */
} icd_crc_form_t;

/** Kinds of checksums. */
typedef enum {
    ICD_CHECK_CRC = 0,
    ICD_CHECK_FLETCHER = 1,
    ICD_CHECK_FLETCHER_255 = 2,
    ICD_CHECK_SUM = 3,
    ICD_CHECK_XOR = 4
} icd_check_kind_t;

/** How a checksum is computed. Kinds other than a CRC use `init`, `xor_out` and `width` of `crc`. */
typedef struct {
    icd_check_kind_t kind;
    icd_crc_form_t crc;
} icd_checksum_algorithm_t;

/** The optional checksum of telecommands and frames. */
typedef struct {
    /** Whether the checksum covers the id byte. */
    bool covers_id;
    /** Buses on which telecommands may have a checksum; bit n: on bus n of icd_bus_t. */
    uint8_t telecommand_buses;
    /** Buses on which telemetry may have a checksum; bit n: on bus n of icd_bus_t. */
    uint8_t telemetry_buses;
    /** Buses on which telecommands must have a checksum; bit n: on bus n of icd_bus_t. */
    uint8_t telecommand_always;
    /** Buses on which telemetry always has a checksum; bit n: on bus n of icd_bus_t. */
    uint8_t telemetry_always;
    /** Length of the checksum. */
    uint8_t bytes;
    const icd_checksum_algorithm_t *algorithm;
} icd_checksum_form_t;

/** A part of the CAN identifier. */
typedef struct {
    uint8_t bits;
    uint8_t shift;
} icd_can_part_t;

/** Kinds of CAN messages. */
typedef enum {
    ICD_CAN_TELECOMMAND = 0,
    ICD_CAN_ACKNOWLEDGE = 1,
    ICD_CAN_REFUSAL = 2,
    ICD_CAN_REQUEST = 3,
    ICD_CAN_REPLY = 4,
    ICD_CAN_REQUEST_REFUSAL = 5
} icd_can_kind_t;

#define ICD_CAN_KINDS 6u

/** CAN messages of several packets. */
typedef struct {
    /** Data bytes of a packet. */
    uint8_t data_bytes;
    /** Index of the byte with the number of packets that follow. */
    uint8_t left_at;
    /** Value of that byte in the last packet. */
    uint8_t left_in_last;
    /** Maximum number of packets of a message. */
    uint32_t packets;
    /** Maximum number of bytes of a message. */
    uint32_t bytes;
    /** Value of unused bytes of the last packet. */
    uint8_t fill;
    /** Longest time between two packets of a message, in milliseconds. */
    uint32_t packet_timeout;
} icd_can_extended_t;

/** CAN. The types are indexed by icd_can_kind_t; -1: the ICD has no such type. */
typedef struct {
    /** Address of the node. */
    uint8_t node_address;
    /** Maximum number of data bytes of one packet; CAN 2.0 allows 8. */
    uint8_t data_bytes;
    icd_can_part_t type;
    icd_can_part_t channel;
    icd_can_part_t source;
    icd_can_part_t destination;
    int32_t types[ICD_CAN_KINDS];
    int32_t extended_types[ICD_CAN_KINDS];
    const icd_can_extended_t *extended; /**< NULL if there are no messages of several packets. */
} icd_can_form_t;

/** A bit of the log mask: id and length of the frame that it selects. The id is -1 if it selects none. */
typedef struct {
    int16_t id;
    uint16_t length;
} icd_log_bit_t;

/** The mask of a log. Each selected frame has a slot, in ascending order of the bits. */
typedef struct {
    /** Length of the mask. */
    uint8_t size;
    /** Whether bit 0 is the most significant bit of a byte. */
    bool msb0;
    /** Length of each frame in a log. */
    uint16_t slot_bytes;
    /** Value of the bytes after a short frame. */
    uint8_t fill;
    const icd_log_bit_t *bits; /**< One entry for each bit of the mask. */
} icd_log_mask_form_t;

/** A number of several bytes. */
typedef struct {
    uint16_t at;
    uint16_t bytes;
} icd_part_t;

/** The file form of a log. */
typedef struct {
    /** Offset of the mask in the header. */
    uint16_t mask_at;
    /** Length of the header. */
    uint16_t header_bytes;
    /** Offset and length of the Unix time in an entry. */
    icd_part_t seconds;
    /** Offset and length of the milliseconds in an entry. */
    icd_part_t milliseconds;
    /** Offset of the selected frames in an entry. */
    uint16_t frames_at;
    /** Type of a log file; -1 if the ICD does not say. */
    int16_t file_type;
} icd_log_file_form_t;

/** The unsolicited form of a log; places are counted from the id. */
typedef struct {
    /** Id of the message. */
    uint8_t id;
    /** Offset of the mask. */
    uint16_t mask_at;
    /** Offset of the selected frames. */
    uint16_t frames_at;
    uint16_t mask_bytes; /**< Length of the mask. */
    uint16_t slot_bytes; /**< Length of each frame. */
} icd_log_message_form_t;

/** A part of a packed time: value = raw * factor + offset. */
typedef struct {
    uint8_t at;
    uint8_t bits;
    uint16_t factor;
    uint16_t offset;
} icd_time_part_t;

/** A packed time. */
typedef struct {
    icd_time_part_t year, month, day, hour, minute, second;
} icd_time_form_t;

/** An entry of the index file. */
typedef struct {
    /** Length of an entry. */
    uint16_t entry_bytes;
    /** Type of the index file; -1 if the ICD does not say. */
    int16_t file_type;
    icd_part_t type, counter, checksum, size, time, meta;
} icd_index_form_t;

/** Role of a field in a message that the wire layer requests. */
typedef enum { ICD_ROLE_NODE_TYPE, ICD_ROLE_INTERFACE_VERSION } icd_role_t;

/** Position of the field with a role, in bits. */
typedef struct {
    icd_role_t role;
    uint16_t at;
    uint16_t bits;
} icd_place_t;

/** A message that the wire layer requests. An id is -1 if the message does not exist in this direction. */
typedef struct {
    int16_t telecommand;
    int16_t telemetry;
    uint16_t length;
    uint8_t place_count;
    const icd_place_t *places;
} icd_report_t;

#endif /* ICDGEN_WIRE_FORMS_H */
