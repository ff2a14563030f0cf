#ifndef ICDGEN_WIRE_STREAM_FORM_H
#define ICDGEN_WIRE_STREAM_FORM_H

#include "../icdgen.h"
#include "forms.h"

/* ---- the envelope of a link, as fields with roles around the data ------------------------------------------------ */

/** What tells where a message ends; ICD_DELIMITED_BY_PACKET: whatever carries it. */
typedef enum {
    ICD_DELIMITED_BY_LENGTH = 0,
    ICD_DELIMITED_BY_SLIP = 1,
    ICD_DELIMITED_BY_COBS = 2,
    ICD_DELIMITED_BY_HDLC = 3,
    ICD_DELIMITED_BY_PACKET = 4
} icd_delimiter_t;

/** What a field of the envelope is. The first ones are those whose values the sender chooses. */
typedef enum {
    ICD_ENVELOPE_SEQUENCE = 0,
    ICD_ENVELOPE_SOURCE = 1,
    ICD_ENVELOPE_DESTINATION = 2,
    ICD_ENVELOPE_TYPE = 3,
    ICD_ENVELOPE_FLAGS = 4,
    ICD_ENVELOPE_TIME = 5,
    ICD_ENVELOPE_CONSTANT = 6,
    ICD_ENVELOPE_ID = 7,
    ICD_ENVELOPE_LENGTH = 8,
    ICD_ENVELOPE_CHECKSUM = 9
} icd_envelope_role_t;

#define ICD_ENVELOPE_VALUES 6 /**< Roles whose values the sender chooses. */

/** A field: `size` bytes from byte `at` of the header or trailer on are a number, shifted and cut to `bits`. */
typedef struct {
    icd_envelope_role_t role;
    bool in_trailer;
    uint8_t at;
    uint8_t size;
    uint8_t shift;
    uint8_t bits;
    bool little;
    uint32_t values[2]; /**< Of a constant, or unless another is chosen: in telecommands, in telemetry. */
} icd_envelope_field_t;

typedef enum {
    ICD_CHECK_CRC = 0,
    ICD_CHECK_FLETCHER = 1,
    ICD_CHECK_FLETCHER_255 = 2,
    ICD_CHECK_SUM = 3,
    ICD_CHECK_XOR = 4
} icd_check_kind_t;

/** The checksum; kinds other than a CRC use init, xor_out and width of the form. */
typedef struct {
    icd_check_kind_t kind;
    icd_crc_form_t crc;
    uint8_t covered_from;    /**< The byte of the header from which on it is computed. */
    uint8_t covered_trailer; /**< Bytes of the trailer that it covers. */
    bool is_seeded;          /**< Whether the seed of the message is covered, as a byte after all others. */
} icd_check_form_t;

/** A message: its id, the lengths that its data can have, and its seed. */
typedef struct {
    uint32_t id;
    uint16_t least;
    uint16_t most;
    bool cuts_zeros; /**< Whether zeros at the end of the data are not sent, but for one byte. */
    uint8_t seed;
    bool is_answered; /**< Whether it is a telecommand that is answered with telemetry, that of the id `reply`. */
    uint32_t reply;
} icd_stream_row_t;

/** How messages are put into a stream of bytes, or into packets. */
typedef struct {
    icd_delimiter_t delimited_by;
    uint8_t header_bytes;
    uint8_t trailer_bytes;
    int32_t length_plus; /**< What the field of the length has more than the data have bytes. */
    bool per_id;         /**< Whether each id counts its own sequence. */
    const icd_envelope_field_t *fields;
    uint8_t field_count;
    const icd_check_form_t *check;
    const icd_stream_row_t *rows[2]; /**< Telecommands and telemetry, by rising id. */
    uint16_t row_counts[2];
} icd_stream_form_t;

#endif /* ICDGEN_WIRE_STREAM_FORM_H */
