#ifndef ICDGEN_WIRE_UPLOAD_C
#define ICDGEN_WIRE_UPLOAD_C

#include "upload.h"
#include "link.c"
#include "files.c"
#include "procedure.c"
#include "download.c"

enum {
    ICDGEN_UPLOAD_START,
    ICDGEN_UPLOAD_INITIATED,
    ICDGEN_UPLOAD_READY,
    ICDGEN_UPLOAD_BEGUN,
    ICDGEN_UPLOAD_PACKET,
    ICDGEN_UPLOAD_MAP,
    ICDGEN_UPLOAD_CHECKSUM,
    ICDGEN_UPLOAD_FINALIZE,
    ICDGEN_UPLOAD_FINALIZED
};

/* Return the number of bytes of the current block. */
static inline uint32_t icdgen_upload_length(const icd_upload_t *upload)
{
    const uint32_t left = upload->size - upload->sent;
    return left < upload->block ? left : upload->block;
}

/* Start the block, for the first time or again. */
static inline void icdgen_upload_begin(icd_upload_t *upload)
{
    icd_procedure_t *const procedure = &upload->procedure;
    const uint32_t packet_bytes = procedure->link->files->packet_bytes;
    upload->count = (icdgen_upload_length(upload) + packet_bytes - 1u) / packet_bytes;
    (void)memset(upload->missing, 0xFF, ICDGEN_SIZE((upload->count + 7u) / 8u));
    icdgen_command(procedure, &procedure->link->upload->begin, true, ICDGEN_UPLOAD_BEGUN);
}

static inline void icdgen_upload_block(icd_upload_t *upload)
{
    upload->rounds = 0;
    if (upload->sent == upload->size) {
        icdgen_end(&upload->procedure, ICD_DONE);
    } else {
        icdgen_upload_begin(upload);
    }
}

/* Write the packet at this position, padded to full length. */
static inline void icdgen_upload_packet(const icd_upload_t *upload, uint32_t position, uint8_t *packet)
{
    const icd_files_form_t *const files = upload->procedure.link->files;
    const uint32_t at = position * files->packet_bytes;
    const uint32_t left = icdgen_upload_length(upload) - at;
    (void)memset(packet, files->fill, files->packet_bytes);
    (void)memcpy(
        packet, upload->file + upload->sent + at, ICDGEN_SIZE(left < files->packet_bytes ? left : files->packet_bytes));
}

/* Send the next missing packet. Return false if none is left in this round. */
static inline bool icdgen_upload_send(icd_upload_t *upload)
{
    icd_procedure_t *const procedure = &upload->procedure;
    const icd_link_t *const link = procedure->link;
    const icd_step_t *const step = &link->upload->packet;
    const icd_place_t *const bytes = icdgen_place(step, ICD_ROLE_BYTES);
    while (upload->next < upload->count && !icdgen_bit(upload->missing, upload->next)) {
        upload->next++;
    }
    if (upload->next == upload->count) {
        return false;
    }
    icdgen_command(procedure, step, false, ICDGEN_UPLOAD_PACKET);
    icdgen_put(link, step, procedure->data, ICD_ROLE_NUMBER, link->files->first_packet + upload->next);
    icdgen_upload_packet(upload, upload->next, procedure->data + (bytes->at / 8u));
    upload->next++;
    return true;
}

/* Start another round, or request the checksum if no packet is missing. */
static inline void icdgen_upload_round(icd_upload_t *upload)
{
    icd_procedure_t *const procedure = &upload->procedure;
    bool any = false;
    for (uint32_t i = 0; i < upload->count; ++i) {
        any = any || icdgen_bit(upload->missing, i);
    }
    if (!any) {
        icdgen_ask(procedure, procedure->link->upload->checksum.telemetry, ICDGEN_UPLOAD_CHECKSUM);
        return;
    }
    if (upload->rounds == procedure->link->upload->rounds) {
        icdgen_end(procedure, ICD_ROUNDS);
        return;
    }
    upload->rounds++;
    upload->next = 0;
    (void)icdgen_upload_send(upload);
}

/* Request the next piece of the hole map. Evaluate it after the last piece. */
static inline void icdgen_upload_map(icd_upload_t *upload)
{
    const icd_hole_map_form_t *const form = upload->procedure.link->hole_map;
    if (upload->next >= form->message_count || upload->next * form->message_bytes * 8u >= upload->count) {
        icdgen_upload_round(upload);
    } else {
        icdgen_ask(&upload->procedure, form->messages[upload->next].telemetry, ICDGEN_UPLOAD_MAP);
    }
}

/* Send the next missing packet, or request the hole map. */
static inline void icdgen_upload_next(icd_upload_t *upload)
{
    if (!icdgen_upload_send(upload)) {
        upload->next = 0;
        icdgen_upload_map(upload);
    }
}

static inline void icdgen_upload_mapped(icd_upload_t *upload, const uint8_t *frame, size_t length)
{
    const icd_hole_map_form_t *const form = upload->procedure.link->hole_map;
    const icd_hole_map_message_t *const message = &form->messages[upload->next];
    const uint32_t first = upload->next * form->message_bytes * 8u;
    if (length != message->length) {
        icdgen_end(&upload->procedure, ICD_LENGTH);
        return;
    }
    for (uint32_t i = 0; i < form->message_bytes * 8u && first + i < upload->count; ++i) {
        const bool one = (frame[message->at + (i / 8u)] & icdgen_hole_bit(form, i)) != 0u;
        icdgen_set_bit(upload->missing, first + i, one != form->received);
    }
    upload->next++;
    icdgen_upload_map(upload);
}

static inline uint32_t icdgen_upload_checksum(const icd_upload_t *upload)
{
    const icd_link_t *const link = upload->procedure.link;
    const uint32_t length = icdgen_upload_length(upload);
    uint32_t left = upload->count * link->files->packet_bytes - length;
    icd_crc_t crc;
    icd_crc_init(&crc, link->crc16);
    icd_crc_feed(&crc, upload->file + upload->sent, ICDGEN_SIZE(length));
    for (left = link->upload->checksum_covers_fill ? left : 0u; left != 0u; --left) {
        icd_crc_feed(&crc, &link->files->fill, 1);
    }
    return icd_crc_result(&crc);
}

/* Process a damaged block: start it again, or end the upload. */
static inline void icdgen_upload_again(icd_upload_t *upload)
{
    if (upload->rounds == upload->procedure.link->upload->rounds) {
        icdgen_end(&upload->procedure, ICD_CHECKSUM);
    } else {
        icdgen_upload_begin(upload);
    }
}

static inline void icdgen_upload_checked(icd_upload_t *upload, const icd_event_t *outcome)
{
    icd_procedure_t *const procedure = &upload->procedure;
    const icd_link_t *const link = procedure->link;
    const icd_step_t *const step = &link->upload->finalize;
    if (outcome->length != link->upload->checksum.length) {
        icdgen_end(procedure, ICD_LENGTH);
        return;
    }
    if (icdgen_get(link, &link->upload->checksum, outcome->data, ICD_ROLE_CHECKSUM) != icdgen_upload_checksum(upload)) {
        icdgen_upload_again(upload);
        return;
    }
    icdgen_command(procedure, step, true, ICDGEN_UPLOAD_FINALIZE);
    icdgen_put(link, step, procedure->data, ICD_ROLE_DESTINATION, upload->destination);
    icdgen_put(link, step, procedure->data, ICD_ROLE_OFFSET, upload->sent);
    icdgen_put(link, step, procedure->data, ICD_ROLE_LENGTH, icdgen_upload_length(upload));
}

static inline void icdgen_upload_finalized(icd_upload_t *upload, const uint8_t *frame)
{
    const icd_link_t *const link = upload->procedure.link;
    if (icdgen_get(link, &link->upload->finalized, frame, ICD_ROLE_ERROR) != 0u) {
        icdgen_upload_again(upload);
        return;
    }
    upload->sent += icdgen_upload_length(upload);
    icdgen_upload_block(upload);
}

static inline void icdgen_upload_start(icd_upload_t *upload)
{
    icd_procedure_t *const procedure = &upload->procedure;
    const icd_link_t *const link = procedure->link;
    const icd_step_t *const step = &link->upload->initiate;
    icdgen_command(procedure, step, true, ICDGEN_UPLOAD_INITIATED);
    icdgen_put(link, step, procedure->data, ICD_ROLE_DESTINATION, upload->destination);
    icdgen_put(link, step, procedure->data, ICD_ROLE_BLOCK_SIZE, link->upload->block_size);
}

static inline void icdgen_upload_resume(icd_procedure_t *procedure, const icd_event_t *outcome)
{
    icd_upload_t *const upload = ICDGEN_CAST(icd_upload_t *, ICDGEN_CAST(void *, procedure));
    const icd_upload_form_t *const form = procedure->link->upload;
    switch (procedure->state) {
    case ICDGEN_UPLOAD_INITIATED:
        icdgen_poll(
            procedure, &form->initiated, ICD_ROLE_BUSY, false, form->poll_interval, form->erase_timeout,
            ICDGEN_UPLOAD_READY);
        break;
    case ICDGEN_UPLOAD_READY:
        icdgen_upload_block(upload);
        break;
    case ICDGEN_UPLOAD_BEGUN:
        icdgen_upload_round(upload);
        break;
    case ICDGEN_UPLOAD_PACKET:
        icdgen_upload_next(upload);
        break;
    case ICDGEN_UPLOAD_MAP:
        icdgen_upload_mapped(upload, outcome->data, outcome->length);
        break;
    case ICDGEN_UPLOAD_CHECKSUM:
        icdgen_upload_checked(upload, outcome);
        break;
    case ICDGEN_UPLOAD_FINALIZE:
        icdgen_poll(
            procedure, &form->finalized, ICD_ROLE_BUSY, false, form->poll_interval, form->finalize_timeout,
            ICDGEN_UPLOAD_FINALIZED);
        break;
    case ICDGEN_UPLOAD_FINALIZED:
        icdgen_upload_finalized(upload, outcome->data);
        break;
    case ICDGEN_UPLOAD_START:
    default:
        icdgen_upload_start(upload);
        break;
    }
}

ICDGEN_API icd_status_t icd_upload_init(
    icd_upload_t *upload,
    const icd_link_t *link,
    uint8_t destination,
    const uint8_t *file,
    uint32_t size,
    uint32_t block,
    uint8_t *bitmap,
    size_t bitmap_size)
{
    const bool known = link->upload != NULL && link->crc16 != NULL && link->hole_map != NULL;
    (void)memset(upload, 0, sizeof *upload);
    if (icdgen_procedure_init(&upload->procedure, link, known, icdgen_upload_resume) != ICD_OK) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if (!icdgen_allowed(link->upload->destinations, link->upload->destinations_count, destination)) {
        return ICD_ERROR_RANGE;
    }
    if (link->upload->destination_bytes != 0u && size > link->upload->destination_bytes) {
        return ICD_ERROR_LENGTH;
    }
    block = block != 0u && block < link->files->block_bytes ? block : link->files->block_bytes;
    if (bitmap_size < icd_block_bitmap(link, block)) {
        return ICD_ERROR_LENGTH;
    }
    upload->destination = destination;
    upload->file = file;
    upload->size = size;
    upload->block = block;
    upload->missing = bitmap;
    return ICD_OK;
}

#endif /* ICDGEN_WIRE_UPLOAD_C */
