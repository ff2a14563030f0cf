#ifndef ICDGEN_WIRE_CAN_C
#define ICDGEN_WIRE_CAN_C

#include "can.h"

static inline uint32_t icdgen_can_part(icd_can_part_t part, uint32_t id)
{
    return (id >> part.shift) & ((UINT32_C(1) << part.bits) - 1u);
}

/* Return whether messages of this kind have data. */
static inline bool icdgen_can_has_data(icd_can_kind_t kind)
{
    return kind == ICD_CAN_TELECOMMAND || kind == ICD_CAN_REPLY;
}

ICDGEN_API size_t icd_can_most(const icd_link_t *link, icd_can_kind_t kind)
{
    const icd_can_form_t *const can = link->can;
    if (can->extended != NULL && can->extended_types[kind] >= 0) {
        return ICDGEN_SIZE(can->extended->bytes);
    }
    return icdgen_can_has_data(kind) ? can->data_bytes : 0u;
}

ICDGEN_API icd_status_t icd_can_split(
    icd_can_splitter_t *splitter,
    const icd_link_t *link,
    icd_can_kind_t kind,
    uint8_t id,
    uint8_t source,
    uint8_t destination,
    const uint8_t *data,
    size_t length)
{
    const icd_can_form_t *const can = link->can;
    int32_t type;
    (void)memset(splitter, 0, sizeof *splitter);
    if (can == NULL) {
        return ICD_ERROR_UNSUPPORTED;
    }
    splitter->extended = length > (icdgen_can_has_data(kind) ? can->data_bytes : 0u);
    if (splitter->extended && length > icd_can_most(link, kind)) {
        return ICD_ERROR_LENGTH;
    }
    type = splitter->extended ? can->extended_types[kind] : can->types[kind];
    if (type < 0) {
        return ICD_ERROR_UNSUPPORTED;
    }
    splitter->id = (ICDGEN_U32(type) << can->type.shift) | (ICDGEN_U32(id) << can->channel.shift) |
        (ICDGEN_U32(source) << can->source.shift) | (ICDGEN_U32(destination) << can->destination.shift);
    if (icdgen_can_part(can->channel, splitter->id) != id || icdgen_can_part(can->source, splitter->id) != source ||
        icdgen_can_part(can->destination, splitter->id) != destination) {
        return ICD_ERROR_RANGE;
    }
    splitter->can = can;
    splitter->data = data;
    splitter->length = length;
    splitter->count = splitter->extended
        ? ICDGEN_U32((length + can->extended->data_bytes - 1u) / can->extended->data_bytes)
        : ICDGEN_U32(1);
    return ICD_OK;
}

ICDGEN_API bool icd_can_next(icd_can_splitter_t *splitter, icd_can_packet_t *packet)
{
    const icd_can_extended_t *form;
    size_t at, size;
    if (splitter->next >= splitter->count) {
        return false;
    }
    form = splitter->can->extended;
    packet->id = splitter->id;
    at = splitter->extended ? ICDGEN_SIZE(splitter->next * form->data_bytes) : 0u;
    size = splitter->length - at;
    (void)memset(packet->data, 0, sizeof packet->data);
    if (splitter->extended) {
        size = size < form->data_bytes ? size : form->data_bytes;
        (void)memset(packet->data, form->fill, form->left_at);
        packet->data[form->left_at] = ICDGEN_U8(form->left_in_last + splitter->count - 1u - splitter->next);
    }
    if (size != 0u) {
        (void)memcpy(packet->data, splitter->data + at, size);
    }
    packet->length = ICDGEN_U8(splitter->extended ? form->left_at + 1u : size);
    splitter->next++;
    return true;
}

#endif /* ICDGEN_WIRE_CAN_C */
