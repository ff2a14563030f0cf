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

/** Upload of a file block by block. Pass `&upload.procedure` to the icd_procedure_...() functions. */
typedef struct {
    icd_procedure_t procedure;
    uint8_t destination;
    const uint8_t *file;
    uint32_t size;
    uint32_t block;
    uint8_t *missing; /* one bit for each packet of the block */
    uint32_t sent;    /**< Progress: bytes committed. */
    uint32_t count;   /* packets of the current block */
    uint32_t next;    /* next packet, or next message of the hole map */
    uint32_t rounds;
} icd_upload_t;

/**
 * Initialize an upload of `size` bytes from `file`. `block`: bytes per block, or 0 for the block size of the ICD.
 * `bitmap` needs icd_block_bitmap() bytes. `file` and `bitmap` must stay valid during the upload.
 * Return ICD_ERROR_UNSUPPORTED if the node has no uploads, ICD_ERROR_RANGE if the destination is not supported,
 * ICD_ERROR_LENGTH if the file is larger than the destination or the bitmap is too small.
 */
ICDGEN_API icd_status_t icd_upload_init(
    icd_upload_t *upload,
    const icd_link_t *link,
    uint8_t destination,
    const uint8_t *file,
    uint32_t size,
    uint32_t block,
    uint8_t *bitmap,
    size_t bitmap_size);

#endif /* ICDGEN_WIRE_UPLOAD_H */
