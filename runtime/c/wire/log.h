#ifndef ICDGEN_WIRE_LOG_H
#define ICDGEN_WIRE_LOG_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "uart.h"

/* ---- telemetry logs ---------------------------------------------------------------------------------------------- */

/** Bytes with a length. */
typedef struct {
    const uint8_t *data;
    size_t length;
} icd_bytes_t;

/** A frame of a log. `id` is -1, and the data the whole slot, where the ICD assigns no frame to the bit. */
typedef struct {
    uint16_t bit;
    int16_t id;
    const uint8_t *data;
    size_t length;
} icd_log_frame_t;

/** Goes through the frames of an entry, in the order of the mask bits. */
typedef struct {
    const icd_log_mask_form_t *form;
    const uint8_t *mask;
    const uint8_t *slot;
    uint16_t bit;
} icd_log_frames_t;

/** Frames of an entry: as many as the mask selects. The node has logs. */
ICDGEN_API size_t icd_log_count(const icd_link_t *link, const uint8_t *mask);

/** `slots`: where they begin, such as `slots` of icd_log_entry_t. */
ICDGEN_API void icd_log_frames(
    icd_log_frames_t *frames, const icd_link_t *link, const uint8_t *mask, const uint8_t *slots);

/** The next frame; false after the last. */
ICDGEN_API bool icd_log_next(icd_log_frames_t *frames, icd_log_frame_t *frame);

/** An entry of a log file: Unix time, and the slots of its frames, for icd_log_frames(). */
typedef struct {
    uint32_t seconds;
    uint32_t milliseconds;
    const uint8_t *mask;
    const uint8_t *slots;
} icd_log_entry_t;

/** Is told of each entry, which lasts until it returns. */
typedef void icd_log_entry_fn(void *context, const icd_log_entry_t *entry);

/** Reads a log file in pieces of any size. */
typedef struct {
    const icd_link_t *link;
    uint8_t *buffer; /* the mask, once it is known, then what there is of an entry */
    size_t length;   /**< At the end of the file: bytes that belong to no whole entry. */
    size_t entry_bytes;
    bool has_mask; /**< Whether the header is complete; the mask is at the beginning of the buffer. */
} icd_log_reader_t;

/** Bytes that a reader needs at most: NODE_LOG_BYTES is the constant for a node. The node has log files. */
ICDGEN_API size_t icd_log_bytes(const icd_link_t *link);

ICDGEN_API icd_status_t
icd_log_reader_init(icd_log_reader_t *reader, const icd_link_t *link, uint8_t *buffer, size_t capacity);

/** Takes the next bytes of the file. */
ICDGEN_API void icd_log_feed(
    icd_log_reader_t *reader, const uint8_t *bytes, size_t count, icd_log_entry_fn *on_entry, void *context);

/** Writes the header of a log file; ICD_ERROR_LENGTH if the mask has another length, or the buffer is too small. */
ICDGEN_API icd_status_t icd_log_write_header(
    const icd_link_t *link, const uint8_t *mask, size_t mask_length, uint8_t *buffer, size_t capacity, size_t *written);

/** Writes an entry of a log file with one frame for each bit of the mask. ICD_ERROR_RANGE if a time does not fit. */
ICDGEN_API icd_status_t icd_log_write_entry(
    const icd_link_t *link,
    const uint8_t *mask,
    uint32_t seconds,
    uint32_t milliseconds,
    const icd_bytes_t *frames,
    size_t count,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

/** An unsolicited log: mask and slots lie within the message. */
typedef struct {
    const uint8_t *mask;
    const uint8_t *slots;
} icd_log_message_t;

/** Bytes of an unsolicited log message with its id, as far as that is known. The node has such messages. */
ICDGEN_API size_t icd_log_message_length(const icd_link_t *link, const uint8_t *message, size_t length);

/**
 * Reads an unsolicited log message, which begins with its id; ICD_ERROR_LENGTH if it is longer or shorter than it must
 * be.
 */
ICDGEN_API icd_status_t
icd_log_message_decode(const icd_link_t *link, const uint8_t *message, size_t length, icd_log_message_t *log);

/** Writes an unsolicited log message with its id. */
ICDGEN_API icd_status_t icd_log_message_encode(
    const icd_link_t *link,
    const uint8_t *mask,
    size_t mask_length,
    const icd_bytes_t *frames,
    size_t count,
    uint8_t *buffer,
    size_t capacity,
    size_t *written);

#endif /* ICDGEN_WIRE_LOG_H */
