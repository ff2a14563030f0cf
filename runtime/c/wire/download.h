#ifndef ICDGEN_WIRE_DOWNLOAD_H
#define ICDGEN_WIRE_DOWNLOAD_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"
#include "events.h"
#include "crc.h"
#include "files.h"
#include "procedure.h"

/** Callback for each block of a file. `data` is valid during the call; `offset` and `length` are in bytes. */
typedef void icd_block_fn(void *context, uint32_t offset, const uint8_t *data, size_t length);

/** Value of `size` for a file whose size is unknown before its end is reached, such as the index file. */
#define ICD_SIZE_UNKNOWN UINT32_C(0xFFFFFFFF)

/** Download of a file block by block. Pass `&download.procedure` to the icd_procedure_...() functions. */
typedef struct {
    icd_procedure_t procedure;
    icd_bus_t bus;
    uint8_t type;
    uint8_t counter;
    uint32_t size;
    uint32_t block; /* bytes requested at once */
    uint8_t *buffer;
    uint8_t *got; /* one bit for each packet of the block */
    icd_block_fn *on_block;
    void *context;
    uint32_t offset;   /**< Progress: bytes passed to `on_block`. */
    uint32_t length;   /* of the current block */
    uint32_t checksum; /* of the current block */
    uint32_t count;    /* packets of the current block */
    uint32_t there;    /* packets received */
    uint32_t rounds;
    uint32_t left; /* I2C, CAN: packets still to be requested; or messages of the hole map sent */
    uint32_t last; /* time of the last new packet */
} icd_download_t;

/**
 * Return the size in bytes of the buffer (and below, of the bitmap) for blocks of at most `block` bytes; 0 if the node
 * has no file transfer.
 */
ICDGEN_API size_t icd_block_buffer(const icd_link_t *link, uint32_t block);

ICDGEN_API size_t icd_block_bitmap(const icd_link_t *link, uint32_t block);

/**
 * Initialize a download. `size`: file size in bytes, or ICD_SIZE_UNKNOWN. `block`: bytes per block, or 0 for the block
 * size of the ICD. `buffer` needs icd_block_buffer() bytes and `bitmap` icd_block_bitmap() bytes; NODE_BLOCK_BYTES and
 * NODE_BLOCK_BITMAP_BYTES are always enough. Both must stay valid during the download.
 * Return ICD_ERROR_LENGTH if a buffer is too small, ICD_ERROR_RANGE if the size is above the limit of the ICD,
 * ICD_ERROR_UNSUPPORTED if the node has no downloads on this bus.
 */
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
    void *context);

#endif /* ICDGEN_WIRE_DOWNLOAD_H */
