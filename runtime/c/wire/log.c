#ifndef ICDGEN_WIRE_LOG_C
#define ICDGEN_WIRE_LOG_C

#include "log.h"
#include "link.c"
#include "uart.c"

ICDGEN_API size_t icd_log_count(const icd_link_t *link, const uint8_t *mask)
{
    return icdgen_log_slots(mask, link->log_mask->size);
}

ICDGEN_API void icd_log_frames(
    icd_log_frames_t *frames, const icd_link_t *link, const uint8_t *mask, const uint8_t *slots)
{
    frames->form = link->log_mask;
    frames->mask = mask;
    frames->slot = slots;
    frames->bit = 0;
}

ICDGEN_API bool icd_log_next(icd_log_frames_t *frames, icd_log_frame_t *frame)
{
    const icd_log_mask_form_t *const form = frames->form;
    while (frames->bit < form->size * 8u) {
        const unsigned bit = frames->bit;
        const unsigned weight = form->msb0 ? 7u - (bit % 8u) : bit % 8u;
        frames->bit++;
        if (((ICDGEN_U32(frames->mask[bit / 8u]) >> weight) & 1u) != 0u) {
            frame->bit = ICDGEN_U16(bit);
            frame->id = form->bits[bit].id;
            frame->length = form->bits[bit].length;
            frame->data = frames->slot;
            frames->slot = frames->slot != NULL ? frames->slot + form->slot_bytes : NULL;
            return true;
        }
    }
    return false;
}

ICDGEN_API size_t icd_log_bytes(const icd_link_t *link)
{
    const icd_log_mask_form_t *const mask = link->log_mask;
    const size_t most =
        ICDGEN_SIZE(mask->size) + link->log_file->frames_at + (ICDGEN_SIZE(mask->size) * 8u * mask->slot_bytes);
    return most > link->log_file->header_bytes ? most : link->log_file->header_bytes;
}

ICDGEN_API icd_status_t
icd_log_reader_init(icd_log_reader_t *reader, const icd_link_t *link, uint8_t *buffer, size_t capacity)
{
    (void)memset(reader, 0, sizeof *reader);
    if (link->log_file == NULL || link->log_mask == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (capacity < icd_log_bytes(link)) {
        return ICD_ERROR_LENGTH;
    }
    reader->link = link;
    reader->buffer = buffer;
    return ICD_OK;
}

static inline void icdgen_log_header(icd_log_reader_t *reader)
{
    const icd_link_t *const link = reader->link;
    (void)memmove(reader->buffer, reader->buffer + link->log_file->mask_at, link->log_mask->size);
    reader->entry_bytes =
        link->log_file->frames_at + (icd_log_count(link, reader->buffer) * link->log_mask->slot_bytes);
    reader->has_mask = true;
    reader->length = 0;
}

static inline void icdgen_log_tell(icd_log_reader_t *reader, icd_log_entry_fn *on_entry, void *context)
{
    const icd_log_file_form_t *const form = reader->link->log_file;
    const uint8_t *const at = reader->buffer + reader->link->log_mask->size;
    icd_log_entry_t entry;
    entry.seconds = icdgen_number(reader->link, at + form->seconds.at, form->seconds.bytes);
    entry.milliseconds = icdgen_number(reader->link, at + form->milliseconds.at, form->milliseconds.bytes);
    entry.mask = reader->buffer;
    entry.slots = at + form->frames_at;
    reader->length = 0;
    on_entry(context, &entry);
}

ICDGEN_API void icd_log_feed(
    icd_log_reader_t *reader, const uint8_t *bytes, size_t count, icd_log_entry_fn *on_entry, void *context)
{
    while (count != 0u) {
        const size_t whole = reader->has_mask ? reader->entry_bytes : reader->link->log_file->header_bytes;
        const size_t before = reader->has_mask ? reader->link->log_mask->size : 0u;
        const size_t wanted = whole - reader->length;
        const size_t taken = wanted < count ? wanted : count;
        (void)memcpy(reader->buffer + before + reader->length, bytes, taken);
        reader->length += taken;
        bytes += taken;
        count -= taken;
        if (reader->length < whole) {
            return;
        }
        if (reader->has_mask) {
            icdgen_log_tell(reader, on_entry, context);
        } else {
            icdgen_log_header(reader);
        }
    }
}

ICDGEN_API icd_status_t icd_log_write_header(
    const icd_link_t *link, const uint8_t *mask, size_t mask_length, uint8_t *buffer, size_t capacity, size_t *written)
{
    if (link->log_file == NULL || link->log_mask == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (mask_length != link->log_mask->size || capacity < link->log_file->header_bytes) {
        return ICD_ERROR_LENGTH;
    }
    (void)memset(buffer, 0, link->log_file->header_bytes);
    (void)memcpy(buffer + link->log_file->mask_at, mask, mask_length);
    *written = link->log_file->header_bytes;
    return ICD_OK;
}

/* Write frames into their slots. Return ICD_ERROR_LENGTH if their number or the length of a frame is wrong. */
static inline icd_status_t icdgen_log_slots_write(
    const icd_link_t *link,
    const uint8_t *mask,
    const icd_bytes_t *given,
    size_t count,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    const size_t size = link->log_mask->slot_bytes;
    icd_log_frames_t frames;
    icd_log_frame_t frame;
    size_t i = 0;
    if (count != icd_log_count(link, mask) || capacity / (size != 0u ? size : 1u) < count) {
        return ICD_ERROR_LENGTH;
    }
    icd_log_frames(&frames, link, mask, NULL);
    while (icd_log_next(&frames, &frame)) {
        if (given[i].length != frame.length) {
            return ICD_ERROR_LENGTH;
        }
        (void)memset(buffer + (i * size), link->log_mask->fill, size);
        if (frame.length != 0u) {
            (void)memcpy(buffer + (i * size), given[i].data, frame.length);
        }
        ++i;
    }
    *written = count * size;
    return ICD_OK;
}

ICDGEN_API icd_status_t icd_log_write_entry(
    const icd_link_t *link,
    const uint8_t *mask,
    uint32_t seconds,
    uint32_t milliseconds,
    const icd_bytes_t *frames,
    size_t count,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    const icd_log_file_form_t *const form = link->log_file;
    size_t slots = 0;
    icd_status_t status;
    if (form == NULL || link->log_mask == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (capacity < form->frames_at) {
        return ICD_ERROR_LENGTH;
    }
    (void)memset(buffer, 0, form->frames_at);
    status = icdgen_put_number(link, buffer + form->seconds.at, form->seconds.bytes, seconds);
    if (status == ICD_OK) {
        status = icdgen_put_number(link, buffer + form->milliseconds.at, form->milliseconds.bytes, milliseconds);
    }
    if (status == ICD_OK) {
        status = icdgen_log_slots_write(
            link, mask, frames, count, buffer + form->frames_at, capacity - form->frames_at, &slots);
    }
    *written = form->frames_at + slots;
    return status;
}

ICDGEN_API size_t icd_log_message_length(const icd_link_t *link, const uint8_t *message, size_t length)
{
    const icd_log_message_form_t *const form = link->log_message;
    return length < form->frames_at
        ? form->frames_at
        : form->frames_at + (icd_log_count(link, message + form->mask_at) * link->log_mask->slot_bytes);
}

ICDGEN_API icd_status_t
icd_log_message_decode(const icd_link_t *link, const uint8_t *message, size_t length, icd_log_message_t *log)
{
    if (link->log_message == NULL || link->log_mask == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (length < link->log_message->frames_at || length != icd_log_message_length(link, message, length)) {
        return ICD_ERROR_LENGTH;
    }
    log->mask = message + link->log_message->mask_at;
    log->slots = message + link->log_message->frames_at;
    return ICD_OK;
}

ICDGEN_API icd_status_t icd_log_message_encode(
    const icd_link_t *link,
    const uint8_t *mask,
    size_t mask_length,
    const icd_bytes_t *frames,
    size_t count,
    uint8_t *buffer,
    size_t capacity,
    size_t *written)
{
    const icd_log_message_form_t *const form = link->log_message;
    size_t slots = 0;
    icd_status_t status;
    if (form == NULL || link->log_mask == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (mask_length != link->log_mask->size || capacity < form->frames_at) {
        return ICD_ERROR_LENGTH;
    }
    (void)memset(buffer, 0, form->frames_at);
    buffer[0] = form->id;
    (void)memcpy(buffer + form->mask_at, mask, mask_length);
    status =
        icdgen_log_slots_write(link, mask, frames, count, buffer + form->frames_at, capacity - form->frames_at, &slots);
    *written = form->frames_at + slots;
    return status;
}

#endif /* ICDGEN_WIRE_LOG_C */
