#ifndef ICDGEN_WIRE_FORMS_H
#define ICDGEN_WIRE_FORMS_H

#include "../icdgen.h"

/* ---- what the ICD says about a node ------------------------------------------------------------------------------ */

typedef enum { ICD_BUS_UART = 0, ICD_BUS_I2C = 1, ICD_BUS_CAN = 2 } icd_bus_t;

typedef enum { ICD_TELECOMMAND = 0, ICD_TELEMETRY = 1 } icd_direction_t;

/** Flags of a telecommand. */
#define ICD_ACKNOWLEDGED 1u  /**< The node acknowledges it. */
#define ICD_EXPECTS_RESET 2u /**< The node restarts instead. */
#define ICD_SETTING 4u       /**< It sets what can be got back, so it may be sent again. */

/** A message under its id in one direction. */
typedef struct {
    uint8_t id;
    uint8_t flags;
    uint16_t length;
} icd_message_t;

/** How messages are delimited on the UART; the escape byte comes before each of the other three. */
typedef struct {
    uint8_t escape;
    uint8_t start;
    uint8_t end;
    uint8_t escaped;    /**< After the escape byte: the escape byte itself as data. */
    bool escapes_id;    /**< Whether the id is escaped like the data. */
    bool ignores_other; /**< Whether an escape byte before any other byte is skipped, or an error. */
} icd_framing_t;

/** The acknowledge on the UART: its length, and where the id of the telecommand and the error code stand. */
typedef struct {
    uint16_t length;
    uint16_t id_at;
    uint16_t error_at;
} icd_acknowledge_t;

/** What an error code means. */
typedef enum {
    ICD_REASON_UNKNOWN = 0,
    ICD_REASON_NONE = 1,
    ICD_REASON_UNKNOWN_ID = 2,
    ICD_REASON_LENGTH = 3,
    ICD_REASON_PARAMETER = 4,
    ICD_REASON_CHECKSUM = 5
} icd_reason_t;

/** An error code and its meaning. */
typedef struct {
    icd_reason_t reason;
    uint32_t code;
} icd_error_code_t;

/** Parameters of a CRC in the notation of the usual catalogues. */
typedef struct {
    uint8_t width;
    bool reflect_in;
    bool reflect_out;
    bool has_empty; /**< Whether `empty` is the value for no bytes at all. */
    uint32_t polynomial;
    uint32_t init;
    uint32_t xor_out;
    uint32_t empty;
    const uint16_t *table; /**< NULL: it is computed without. */
} icd_crc_form_t;

/** The optional checksum of telecommands and frames. */
typedef struct {
    icd_crc_form_t crc;
    bool covers_id;
    uint8_t telecommand_buses; /**< Bit n: on bus n of icd_bus_t. */
    uint8_t telemetry_buses;
    uint8_t bytes; /**< That it adds to a message. */
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

/** CAN. Message types are -1 where the ICD has none; they stand in the order of icd_can_kind_t. */
typedef struct {
    icd_can_part_t type;
    icd_can_part_t channel;
    icd_can_part_t source;
    icd_can_part_t destination;
    uint8_t node_address;
    uint8_t data_bytes; /**< Most of a packet. */
    int32_t types[ICD_CAN_KINDS];
    int32_t extended_types[ICD_CAN_KINDS];
    bool extended;           /**< Whether there are messages of several packets; the rest is about them. */
    uint8_t packet_bytes;    /**< Data of each of their packets. */
    uint8_t left_at;         /**< Where the count of packets still to come stands. */
    uint8_t left_in_last;    /**< That count in the last packet. */
    uint8_t fill;            /**< Of what is left of the last packet. */
    uint32_t most_bytes;     /**< Of a message. */
    uint32_t packet_timeout; /**< Milliseconds from packet to packet. */
} icd_can_form_t;

/** A bit of the log mask: the frame that it selects, id -1 for none, and its bytes. */
typedef struct {
    int16_t id;
    uint16_t length;
} icd_log_bit_t;

/** The mask of a log. Frames stand in slots, in the order of rising bits. */
typedef struct {
    uint8_t bytes;
    bool msb0;
    uint8_t fill;
    uint16_t slot_bytes;
    const icd_log_bit_t *bits; /**< One for every bit of the mask. */
} icd_log_mask_form_t;

/** A number of several bytes. */
typedef struct {
    uint16_t at;
    uint16_t bytes;
} icd_part_t;

/** The file form of a log. */
typedef struct {
    uint16_t mask_at;
    uint16_t header_bytes;
    icd_part_t seconds;
    icd_part_t milliseconds;
    uint16_t frames_at;
} icd_log_file_form_t;

/** The unsolicited form of a log; places are counted from the id. */
typedef struct {
    uint8_t id;
    uint16_t mask_at;
    uint16_t frames_at;
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
    uint16_t bytes;
    icd_part_t type, counter, checksum, size, time, meta;
} icd_index_form_t;

/** What a field means for a procedure. */
typedef enum {
    ICD_ROLE_TYPE,
    ICD_ROLE_COUNTER,
    ICD_ROLE_OFFSET,
    ICD_ROLE_LENGTH,
    ICD_ROLE_READY,
    ICD_ROLE_ERROR,
    ICD_ROLE_CHECKSUM,
    ICD_ROLE_IGNORE_HOLE_MAP,
    ICD_ROLE_DESTINATION,
    ICD_ROLE_BLOCK_SIZE,
    ICD_ROLE_BUSY,
    ICD_ROLE_NUMBER,
    ICD_ROLE_BYTES,
    ICD_ROLE_ALL,
    ICD_ROLE_SIZE,
    ICD_ROLE_TIME,
    ICD_ROLE_NODE_TYPE,
    ICD_ROLE_INTERFACE_VERSION,
    ICD_ROLE_ID,
    ICD_ROLE_PROCESSED,
    ICD_ROLE_PARAMETER,
    ICD_ROLE_PROGRAM
} icd_role_t;

/** Where the field of a role lies, in bits. */
typedef struct {
    icd_role_t role;
    uint16_t at;
    uint16_t bits;
} icd_place_t;

/** A message that plays a part in a procedure; an id is -1 where it has none in that direction. */
typedef struct {
    int16_t telecommand;
    int16_t telemetry;
    uint16_t length;
    uint8_t place_count;
    const icd_place_t *places;
    const uint8_t *fresh; /**< The frame before values are put into it. */
} icd_step_t;

/** A message that carries a piece of the hole map. */
typedef struct {
    int16_t telecommand;
    int16_t telemetry;
    uint16_t length;
    uint16_t at;
} icd_hole_map_message_t;

/** A bit for each packet of a block. */
typedef struct {
    uint16_t bytes;
    uint16_t message_bytes; /**< In each message. */
    bool msb0;
    bool received;   /**< The bit of a packet that was received. */
    bool beyond_end; /**< The bits beyond the end of the block. */
    uint8_t message_count;
    const icd_hole_map_message_t *messages;
} icd_hole_map_form_t;

/** Files and their blocks. An id is -1 where there are no download packets on that bus. */
typedef struct {
    uint16_t packet_bytes;
    uint8_t counter_bytes;
    uint16_t first_packet;
    uint8_t fill;
    uint32_t block_bytes;
    int16_t packet_ids[3];
} icd_files_form_t;

/** Listing files. Times are in milliseconds, here and below. */
typedef struct {
    icd_step_t reset, advance, information;
    uint32_t poll_interval;
    uint32_t timeout;
} icd_list_form_t;

/** Downloading a file. */
typedef struct {
    icd_step_t load, ready, burst;
    uint32_t message_length;
    uint32_t poll_interval;
    uint32_t ready_timeout;
    uint32_t silence;
    uint32_t rounds;
    bool checksum_covers_fill;
} icd_download_form_t;

/** Uploading a file. */
typedef struct {
    icd_step_t initiate, initiated, begin, packet, checksum, finalize, finalized;
    uint32_t block_size;
    uint32_t poll_interval;
    uint32_t erase_timeout;
    uint32_t finalize_timeout;
    uint32_t rounds;
    bool checksum_covers_fill;
    uint32_t destination_bytes;  /**< That a destination holds, 0 if the ICD does not say. */
    const uint8_t *destinations; /**< Those that are supported, NULL for all. */
    uint16_t destination_count;
} icd_upload_form_t;

/** Erasing files, or formatting their medium. */
typedef struct {
    icd_step_t request, progress;
    uint32_t poll_interval;
    uint32_t timeout;
} icd_erase_form_t;

/** What a telecommand starts for a stored program, and a frame tells the end of. */
typedef struct {
    icd_step_t request, progress;
    uint32_t poll_interval;
    uint32_t timeout;
    const uint8_t *programs; /**< Those that it may be asked for, NULL for all. */
    uint16_t program_count;
} icd_operation_form_t;

#endif /* ICDGEN_WIRE_FORMS_H */
