#ifndef ICDGEN_WIRE_UPLOAD_H
#define ICDGEN_WIRE_UPLOAD_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "crc.h"
#include "files.h"
#include "procedure.h"
#include "download.h"

/** Uploads a file block by block. `procedure` goes to the functions of icd_procedure_t. */
typedef struct {
    icd_procedure_t procedure;
    uint8_t destination;
    const uint8_t *file;
    uint32_t size;
    uint32_t block;
    uint8_t *missing; /* a bit for each packet of the block */
    uint32_t sent;    /**< Progress: bytes committed. */
    uint32_t count;   /* packets of this block */
    uint32_t next;    /* the packet, or the message of the hole map, that comes next */
    uint32_t rounds;
} icd_upload_t;

/**
 * The file must stay where it is. `block`: bytes a block, 0 for those of the ICD. `bitmap` holds icd_block_bitmap()
 * bytes. ICD_ERROR_UNSUPPORTED if the node takes no uploads, ICD_ERROR_RANGE if the destination is not supported,
 * ICD_ERROR_LENGTH if it holds less.
 */
ICDGEN_API icd_status_t icd_upload_init(
    icd_upload_t *upload,
    const icd_link_t *link,
    uint8_t destination,
    const uint8_t *file,
    uint32_t size,
    uint32_t block,
    uint8_t *bitmap);

#endif /* ICDGEN_WIRE_UPLOAD_H */
