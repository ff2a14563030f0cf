#ifndef ICDGEN_WIRE_DOWNLOAD_C
#define ICDGEN_WIRE_DOWNLOAD_C

#include "download.h"
#include "link.c"
#include "events.c"
#include "files.c"
#include "procedure.c"

/* Return the number of packets of a block; a block has at most the bytes of the ICD. */
static inline uint32_t icdgen_block_packets(const icd_link_t *link, uint32_t block)
{
    const icd_files_form_t *const files = link->files;
    if (files == NULL) {
        return 0u;
    }
    return ((block < files->block_bytes ? block : files->block_bytes) + files->packet_bytes - 1u) / files->packet_bytes;
}

ICDGEN_API size_t icd_block_buffer(const icd_link_t *link, uint32_t block)
{
    return ICDGEN_SIZE(icdgen_block_packets(link, block) * (link->files != NULL ? link->files->packet_bytes : 0u));
}

ICDGEN_API size_t icd_block_bitmap(const icd_link_t *link, uint32_t block)
{
    return ICDGEN_SIZE((icdgen_block_packets(link, block) + 7u) / 8u);
}

enum {
    ICDGEN_DOWNLOAD_START,
    ICDGEN_DOWNLOAD_LOADED,
    ICDGEN_DOWNLOAD_READY,
    ICDGEN_DOWNLOAD_MAPPED,
    ICDGEN_DOWNLOAD_BURST,
    ICDGEN_DOWNLOAD_SILENCE,
    ICDGEN_DOWNLOAD_FETCHED
};

static inline bool icdgen_bit(const uint8_t *bits, uint32_t position)
{
    return ((ICDGEN_U32(bits[position / 8u]) >> (position % 8u)) & 1u) != 0u;
}

static inline void icdgen_set_bit(uint8_t *bits, uint32_t position, bool one)
{
    const uint32_t bit = UINT32_C(1) << (position % 8u);
    bits[position / 8u] = ICDGEN_U8(one ? bits[position / 8u] | bit : bits[position / 8u] & ~bit);
}

static inline icd_download_t *icdgen_download(icd_procedure_t *procedure)
{
    return ICDGEN_CAST(icd_download_t *, ICDGEN_CAST(void *, procedure));
}

static inline void icdgen_download_packet(
    icd_procedure_t *procedure, uint32_t number, const uint8_t *data, size_t length)
{
    icd_download_t *const download = icdgen_download(procedure);
    const icd_files_form_t *const files = procedure->link->files;
    const uint32_t position = number - files->first_packet;
    if (position >= download->count || length != files->packet_bytes || icdgen_bit(download->got, position)) {
        return;
    }
    icdgen_set_bit(download->got, position, true);
    (void)memcpy(download->buffer + (ICDGEN_CAST(size_t, position) * length), data, length);
    download->there++;
    download->last = procedure->now;
    if (download->there == download->count && procedure->want == ICDGEN_WANT_TIME) {
        procedure->until = procedure->now;
    }
}

/* Return the number of bytes to request next; 0 at the end of the file. */
static inline uint32_t icdgen_download_wanted(const icd_download_t *download)
{
    const uint32_t left = download->size - download->offset;
    return download->size == ICD_SIZE_UNKNOWN || left > download->block ? download->block : left;
}

static inline void icdgen_download_load(icd_download_t *download)
{
    icd_procedure_t *const procedure = &download->procedure;
    const icd_link_t *const link = procedure->link;
    const icd_step_t *const step = &link->download->load;
    if (icdgen_download_wanted(download) == 0u) {
        icdgen_end(procedure, ICD_DONE);
        return;
    }
    download->count = 0;
    download->there = 0;
    icdgen_command(procedure, step, true, ICDGEN_DOWNLOAD_LOADED);
    icdgen_put(link, step, procedure->data, ICD_ROLE_TYPE, download->type);
    icdgen_put(link, step, procedure->data, ICD_ROLE_COUNTER, download->counter);
    icdgen_put(link, step, procedure->data, ICD_ROLE_OFFSET, download->offset);
    icdgen_put(link, step, procedure->data, ICD_ROLE_LENGTH, icdgen_download_wanted(download));
}

static inline void icdgen_download_burst(icd_download_t *download)
{
    icd_procedure_t *const procedure = &download->procedure;
    const icd_link_t *const link = procedure->link;
    const icd_step_t *const step = &link->download->burst;
    download->left = download->count - download->there;
    download->last = procedure->now;
    /* Sent only once: the received packets show whether the node got it, even if the acknowledge is lost. */
    icdgen_command(procedure, step, false, ICDGEN_DOWNLOAD_BURST);
    procedure->tolerant = true;
    icdgen_put(link, step, procedure->data, ICD_ROLE_LENGTH, link->download->message_length);
    icdgen_put(link, step, procedure->data, ICD_ROLE_IGNORE_HOLE_MAP, download->there == 0u ? 1u : 0u);
}

/* Send the next piece of the hole map. After the last piece, request the packets. */
static inline void icdgen_download_map(icd_download_t *download)
{
    icd_procedure_t *const procedure = &download->procedure;
    const icd_hole_map_form_t *const form = procedure->link->hole_map;
    const uint32_t first = download->left * form->message_bytes * 8u;
    const icd_hole_map_message_t *const message = &form->messages[download->left];
    icd_step_t step;
    if (first >= download->count || download->left >= form->message_count) {
        icdgen_download_burst(download);
        return;
    }
    (void)memset(&step, 0, sizeof step);
    step.telecommand = message->telecommand;
    step.length = message->length;
    icdgen_command(procedure, &step, true, ICDGEN_DOWNLOAD_MAPPED);
    for (uint32_t i = 0; i < form->message_bytes * 8u; ++i) {
        const uint32_t position = first + i;
        const bool one =
            position >= download->count ? form->beyond_end : icdgen_bit(download->got, position) == form->received;
        icdgen_hole_put(form, procedure->data + message->at, i, one);
    }
    download->left++;
}

/* Deliver the complete block and request the next one. */
static inline void icdgen_download_block(icd_download_t *download)
{
    icd_procedure_t *const procedure = &download->procedure;
    const icd_link_t *const link = procedure->link;
    const size_t covered =
        link->download->checksum_covers_fill ? icd_block_buffer(link, download->length) : ICDGEN_SIZE(download->length);
    const uint32_t wanted = icdgen_download_wanted(download);
    if (icd_crc(link->crc16, download->buffer, covered) != download->checksum) {
        if (download->rounds == link->download->rounds) {
            icdgen_end(procedure, ICD_CHECKSUM);
            return;
        }
        download->rounds += download->length == 0u ? 1u : 0u;
        icdgen_download_load(download);
        return;
    }
    if (download->length != 0u) {
        download->on_block(download->context, download->offset, download->buffer, ICDGEN_SIZE(download->length));
        download->offset += download->length;
    }
    if (download->size == ICD_SIZE_UNKNOWN && download->length < wanted) {
        icdgen_end(procedure, ICD_DONE);
        return;
    }
    download->rounds = 0;
    icdgen_download_load(download);
}

/* Start another round if packets are missing. */
static inline void icdgen_download_round(icd_download_t *download)
{
    icd_procedure_t *const procedure = &download->procedure;
    if (download->there == download->count) {
        icdgen_download_block(download);
        return;
    }
    if (download->rounds == procedure->link->download->rounds) {
        icdgen_end(procedure, ICD_ROUNDS);
        return;
    }
    download->rounds++;
    download->left = 0;
    if (download->there != 0u) {
        icdgen_download_map(download);
    } else {
        icdgen_download_burst(download);
    }
}

static inline void icdgen_download_ready(icd_download_t *download, const uint8_t *frame)
{
    icd_procedure_t *const procedure = &download->procedure;
    const icd_link_t *const link = procedure->link;
    const icd_step_t *const step = &link->download->ready;
    const uint32_t wanted = icdgen_download_wanted(download);
    if (icdgen_get(link, step, frame, ICD_ROLE_ERROR) != 0u) {
        icdgen_end(procedure, ICD_PARAMETER);
        return;
    }
    download->length = icdgen_get(link, step, frame, ICD_ROLE_LENGTH);
    download->checksum = icdgen_get(link, step, frame, ICD_ROLE_CHECKSUM);
    if (download->length > wanted || (download->size != ICD_SIZE_UNKNOWN && download->length != wanted)) {
        icdgen_end(procedure, ICD_LENGTH);
        return;
    }
    if (download->length > link->download->max_bytes - download->offset) {
        icdgen_end(procedure, ICD_LIMIT);
        return;
    }
    download->count = (download->length + link->files->packet_bytes - 1u) / link->files->packet_bytes;
    (void)memset(download->got, 0, icd_block_bitmap(link, download->length));
    icdgen_download_round(download);
}

/* I2C, CAN: request the next packet, or end the round. */
static inline void icdgen_download_fetch(icd_download_t *download)
{
    icd_procedure_t *const procedure = &download->procedure;
    if (download->left == 0u) {
        icdgen_download_round(download);
        return;
    }
    download->left--;
    icdgen_ask(procedure, procedure->link->files->packet_ids[download->bus], ICDGEN_DOWNLOAD_FETCHED);
    procedure->tolerant = true;
}

/* UART: wait until all packets are received or no packet arrives for the silence time. */
static inline void icdgen_download_silence(icd_download_t *download)
{
    icd_procedure_t *const procedure = &download->procedure;
    const uint32_t end = download->last + procedure->link->download->silence;
    if (download->there == download->count || icdgen_reached(procedure->now, end)) {
        icdgen_download_round(download);
        return;
    }
    procedure->state = ICDGEN_DOWNLOAD_SILENCE;
    icdgen_wait(procedure, end);
}

static inline void icdgen_download_resume(icd_procedure_t *procedure, const icd_event_t *outcome)
{
    icd_download_t *const download = icdgen_download(procedure);
    const icd_link_t *const link = procedure->link;
    const icd_download_form_t *const form = link->download;
    const size_t head = link->files->counter_bytes;
    switch (procedure->state) {
    case ICDGEN_DOWNLOAD_LOADED:
        icdgen_poll(
            procedure, &form->ready, ICD_ROLE_READY, true, form->poll_interval, form->ready_timeout,
            ICDGEN_DOWNLOAD_READY);
        break;
    case ICDGEN_DOWNLOAD_READY:
        icdgen_download_ready(download, outcome->data);
        break;
    case ICDGEN_DOWNLOAD_MAPPED:
        icdgen_download_map(download);
        break;
    case ICDGEN_DOWNLOAD_BURST:
        if (outcome->kind == ICD_EVENT_REFUSED) {
            icdgen_end(procedure, ICD_REFUSED);
        } else if (download->bus != ICD_BUS_UART) {
            icdgen_download_fetch(download);
        } else {
            download->last = procedure->now;
            icdgen_download_silence(download);
        }
        break;
    case ICDGEN_DOWNLOAD_SILENCE:
        icdgen_download_silence(download);
        break;
    case ICDGEN_DOWNLOAD_FETCHED:
        if (outcome->kind == ICD_EVENT_DONE && outcome->length >= head) {
            icdgen_download_packet(
                procedure, icdgen_number(link, outcome->data, head), outcome->data + head, outcome->length - head);
        }
        icdgen_download_fetch(download);
        break;
    case ICDGEN_DOWNLOAD_START:
    default:
        icdgen_download_load(download);
        break;
    }
}

ICDGEN_API icd_status_t icd_download_init(
    icd_download_t *download,
    const icd_link_t *link,
    icd_bus_t bus,
    uint8_t type,
    uint8_t counter,
    uint32_t size,
    uint32_t block,
    uint8_t *buffer,
    size_t buffer_size,
    uint8_t *bitmap,
    size_t bitmap_size,
    icd_block_fn *on_block,
    void *context)
{
    const bool known = link->download != NULL && link->files != NULL && link->crc16 != NULL && link->hole_map != NULL &&
        (bus == ICD_BUS_UART || link->files->packet_ids[bus] >= 0);
    (void)memset(download, 0, sizeof *download);
    if (icdgen_procedure_init(&download->procedure, link, known, icdgen_download_resume) != ICD_OK) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (size != ICD_SIZE_UNKNOWN && size > link->download->max_bytes) {
        return ICD_ERROR_RANGE;
    }
    block = block != 0u && block < link->files->block_bytes ? block : link->files->block_bytes;
    if (buffer_size < icdgen_block_packets(link, block) * link->files->packet_bytes ||
        bitmap_size < icd_block_bitmap(link, block)) {
        return ICD_ERROR_LENGTH;
    }
    download->procedure.packet = icdgen_download_packet;
    download->bus = bus;
    download->type = type;
    download->counter = counter;
    download->size = size;
    download->block = block;
    download->buffer = buffer;
    download->got = bitmap;
    download->on_block = on_block;
    download->context = context;
    return ICD_OK;
}

#endif /* ICDGEN_WIRE_DOWNLOAD_C */
