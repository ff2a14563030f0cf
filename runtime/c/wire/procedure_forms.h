#ifndef ICDGEN_WIRE_PROCEDURE_FORMS_H
#define ICDGEN_WIRE_PROCEDURE_FORMS_H

#include "../icdgen.h"
#include "forms.h"
#include "stream_form.h"

/* ---- description of the procedures of a node --------------------------------------------------------------------- */

/** Value of an optional input that is not given, such as the size of a file that is read to its end. */
#define ICD_UNKNOWN UINT32_C(0xFFFFFFFF)

/** Registers of a procedure. The inputs that are numbers follow, then fields of telemetry. */
typedef enum {
    ICD_BLOCK_OFFSET,
    ICD_BLOCK_LENGTH,
    ICD_BLOCK_IS_EMPTY, /**< 1 until a packet of the block has been received. */
    ICD_PACKET_NUMBER,
    ICD_PACKET_OFFSET,
    ICD_FIRST_INPUT
} icd_register_t;

/** A constant, or the content of the register with this index. */
typedef struct {
    uint32_t number;
    bool in_register;
} icd_value_t;

/** Field of a telecommand that gets a value. */
typedef struct {
    icd_number_place_t place;
    icd_value_t value;
} icd_put_t;

/** Field of telemetry that is kept in a register. */
typedef struct {
    icd_number_place_t place;
    uint8_t into;
} icd_take_t;

/** Whether a register is equal to a value. */
typedef struct {
    uint8_t of;
    icd_value_t value;
} icd_test_t;

/** Sends a telecommand. */
typedef struct {
    uint32_t id;
    uint16_t length;
    const uint8_t *data; /**< Before the values are put into it; NULL: zeros. */
    const icd_put_t *puts;
    uint8_t put_count;
    int32_t packet_at;    /**< Where the bytes of the packet stand; -1: nowhere. */
    bool repeats;         /**< Whether it may be sent again after a time-out. */
    bool ignores_timeout; /**< Whether a time-out counts as done. */
} icd_send_form_t;

/** Requests telemetry until all tests hold. Without tests, one request. */
typedef struct {
    uint32_t id;
    const icd_take_t *takes;
    const icd_test_t *tests; /**< First those that must hold, then those that must not. */
    uint8_t take_count;
    uint8_t until_count;
    uint8_t fails_count;
    uint32_t interval; /**< In milliseconds. */
    uint32_t timeout;  /**< In milliseconds. */
} icd_poll_form_t;

/** Receives packets. */
typedef struct {
    uint32_t id;
    icd_number_place_t number;
    uint16_t data_at;
    uint32_t silence;     /**< In milliseconds. */
    uint8_t requested_on; /**< Buses on which packets are requested; bit n: on bus n of icd_bus_t. */
} icd_receive_form_t;

/** Compares a checksum with a value. */
typedef struct {
    const icd_checksum_algorithm_t *algorithm;
    bool of_block;    /**< Of the block; otherwise of all bytes to send. */
    bool covers_fill; /**< Whether it covers the fill of the last packet. */
    icd_value_t value;
} icd_checksum_test_t;

typedef enum {
    ICD_STEP_SEND,
    ICD_STEP_POLL,
    ICD_STEP_NEXT_BLOCK,   /* without another block, continue at `to` */
    ICD_STEP_SET_LENGTH,   /* of the block, which is then at most the requested one */
    ICD_STEP_NEXT_ROUND,   /* if no packet is missing, continue at `to` */
    ICD_STEP_NEXT_PACKET,  /* without another missing packet in this round, continue at `to` */
    ICD_STEP_PACKET_DONE,  /* the packet is no longer missing */
    ICD_STEP_SEND_MAP,     /* of the received packets */
    ICD_STEP_GET_MAP,      /* of the received packets */
    ICD_STEP_RECEIVE,      /* packets */
    ICD_STEP_VERIFY_CRC,   /* otherwise transfer the block again, or end */
    ICD_STEP_VERIFY,       /* otherwise transfer the block again, or end */
    ICD_STEP_COLLECT,      /* the telemetry is the next entry */
    ICD_STEP_END_IF_ZEROS, /* end if all bytes of the telemetry are 0 */
    ICD_STEP_SKIP_UNLESS,  /* continue at `to` unless the test holds */
    ICD_STEP_JUMP          /* continue at `to` */
} icd_step_kind_t;

/** A step. The next one follows unless it continues elsewhere. */
typedef struct {
    uint8_t kind;  /**< See icd_step_kind_t. */
    uint8_t index; /**< In the array of what the step does; of SET_LENGTH and tests in `tests`. */
    bool again;    /**< VERIFY, VERIFY_CRC: whether to transfer the block again. */
    uint16_t to;   /**< Index of the step where it continues. */
} icd_step_form_t;

/** Limits of an input. */
typedef struct {
    uint32_t most;
    const uint32_t *values; /**< Supported values; NULL: all. */
    uint16_t value_count;
    bool is_optional; /**< It may be ICD_UNKNOWN. */
} icd_input_form_t;

/** A message with a piece of the map of received packets. */
typedef struct {
    uint32_t telecommand;
    uint32_t telemetry;
} icd_map_message_t;

/** Map of the received packets of a block, with one bit for each packet. */
typedef struct {
    const icd_map_message_t *messages;
    uint8_t message_count;
    uint16_t length; /**< Of each message. */
    uint16_t at;     /**< Offset of the bytes of the map in each message. */
    uint16_t bytes;  /**< Of the map in each message. */
    bool msb0;       /**< Whether bit 0 is the most significant bit of a byte. */
    bool received;   /**< Value of the bit of a received packet. */
    bool beyond_end; /**< Value of the bits of packets beyond the end of the block. */
} icd_map_form_t;

/** Blocks of the bytes that a procedure sends or receives, and their packets. */
typedef struct {
    bool sends;
    uint8_t total;  /**< Register with the number of bytes; 0: until a shorter block. */
    uint16_t begin; /**< Index of the first step of a block. */
    uint32_t size;  /**< Largest number of bytes of a block. */
    uint16_t packet_bytes;
    uint32_t first_packet; /**< Number of the first packet of a block. */
    uint8_t fill;          /**< Value of the bytes after the end of the block. */
    uint32_t rounds;       /**< Largest number of rounds of a block. */
    uint32_t most;         /**< Largest number of bytes in all. */
    const icd_map_form_t *map;
} icd_blocks_form_t;

/** A procedure: steps that a client runs one after another. */
typedef struct {
    const icd_step_form_t *steps;
    uint16_t step_count;
    const icd_send_form_t *sends;
    const icd_poll_form_t *polls;
    const icd_receive_form_t *receives;
    const icd_checksum_test_t *checksums;
    const icd_test_t *tests;
    const icd_input_form_t *inputs; /**< Inputs that are numbers. */
    uint8_t input_count;
    uint8_t receive_count;
    const icd_blocks_form_t *blocks; /**< NULL if it transfers no blocks. */
    uint32_t most_bytes;             /**< Largest number of bytes to send. */
    uint32_t most_entries;
    uint32_t time;     /**< Longest duration, in milliseconds. */
    uint32_t requests; /**< Largest number of requests. */
} icd_procedure_form_t;

#endif /* ICDGEN_WIRE_PROCEDURE_FORMS_H */
