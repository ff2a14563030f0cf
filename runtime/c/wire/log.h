#ifndef ICDGEN_WIRE_LOG_H
#define ICDGEN_WIRE_LOG_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "uart.h"

/* ---- telemetry logs ---------------------------------------------------------------------------------------------- */

/** A pointer to bytes and their number. */
typedef struct {
    const uint8_t *data;
    size_t length;
} icd_bytes_t;

/** A frame of a log. If the ICD assigns no frame to the bit, `id` is -1 and the data are the whole slot. */
typedef struct {
    uint16_t bit;
    int16_t id;
    const uint8_t *data;
    size_t length;
} icd_log_frame_t;

/** Iterator over the frames of an entry, in the order of the mask bits. */
typedef struct {
    const icd_log_mask_form_t *form;
    const uint8_t *mask;
    const uint8_t *slot;
    uint16_t bit;
} icd_log_frames_t;

/** Return the number of frames that the mask selects. The link must describe logs. */
ICDGEN_API size_t icd_log_count(const icd_link_t *link, const uint8_t *mask);

/** Start the iteration. `mask` and `slots` are those of icd_log_entry_t or icd_log_message_t. */
ICDGEN_API void icd_log_frames(
    icd_log_frames_t *frames, const icd_link_t *link, const uint8_t *mask, const uint8_t *slots);

/** Write the next frame to `frame`. Return false after the last frame. */
ICDGEN_API bool icd_log_next(icd_log_frames_t *frames, icd_log_frame_t *frame);

/** An entry of a log file: Unix time, mask and slots. Pass mask and slots to icd_log_frames(). */
typedef struct {
    uint32_t seconds;
    uint32_t milliseconds;
    const uint8_t *mask;
    const uint8_t *slots;
} icd_log_entry_t;

/** Callback for each entry. The entry is valid during the call. */
typedef void icd_log_entry_fn(void *context, const icd_log_entry_t *entry);

/** Reader of a log file in pieces of any size. */
typedef struct {
    const icd_link_t *link;
    uint8_t *buffer; /* the mask, followed by the bytes of an incomplete entry */
    size_t length;   /**< At the end of the file: bytes of an incomplete entry. */
    size_t entry_bytes;
    bool has_mask; /**< Whether the header is complete. The mask is then at the beginning of the buffer. */
} icd_log_reader_t;

/**
 * Return the buffer size of a reader in bytes. NODE_LOG_BYTES is the constant of a node. The link must describe log
 * files.
 */
ICDGEN_API size_t icd_log_bytes(const icd_link_t *link);

ICDGEN_API icd_status_t
icd_log_reader_init(icd_log_reader_t *reader, const icd_link_t *link, uint8_t *buffer, size_t capacity);

/** Pass the next bytes of the file to the reader. Calls `on_entry` for each complete entry. */
ICDGEN_API void icd_log_feed(
    icd_log_reader_t *reader, const uint8_t *bytes, size_t count, icd_log_entry_fn *on_entry, void *context);

/**
 * Write the header of a log file. Return ICD_ERROR_LENGTH if the mask has the wrong length or the buffer is too small.
 */
ICDGEN_API icd_status_t icd_log_write_header(
    const icd_link_t *link, const uint8_t *mask, size_t mask_length, uint8_t *buffer, size_t capacity, size_t *written);

/**
 * Write an entry of a log file, with one frame for each selected bit of the mask. Return ICD_ERROR_RANGE if the time
 * does not fit, ICD_ERROR_LENGTH if the number or the length of the frames is wrong or the buffer is too small.
 */
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

/** An unsolicited log message. `mask` and `slots` point into the message. */
typedef struct {
    const uint8_t *mask;
    const uint8_t *slots;
} icd_log_message_t;

/**
 * Return the length in bytes of an unsolicited log message with its id, as far as it follows from the first `length`
 * bytes. The link must describe such messages.
 */
ICDGEN_API size_t icd_log_message_length(const icd_link_t *link, const uint8_t *message, size_t length);

/** Decode an unsolicited log message, which starts with its id. Return ICD_ERROR_LENGTH if it has the wrong length. */
ICDGEN_API icd_status_t
icd_log_message_decode(const icd_link_t *link, const uint8_t *message, size_t length, icd_log_message_t *log);

/** Encode an unsolicited log message with its id. */
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
