#ifndef ICDGEN_WIRE_PROCEDURE_FORMS_H
#define ICDGEN_WIRE_PROCEDURE_FORMS_H

#include "../icdgen.h"
#include "forms.h"

/** Listing files. */
typedef struct {
    /** Returns to the first file. */
    icd_step_t reset;
    /** Advances to the next file. */
    icd_step_t advance;
    /** Describes a file. */
    icd_step_t information;
    /** Time between two polls of the busy flag, in milliseconds. */
    uint32_t poll_interval;
    /** Longest time that the busy flag is set, in milliseconds. */
    uint32_t timeout;
    /** Maximum number of files in the list. */
    uint32_t max_entries;
} icd_list_form_t;

/** Downloading a file. */
typedef struct {
    /** Loads a block. */
    icd_step_t load;
    /** Reports that the block is loaded. */
    icd_step_t ready;
    /** Starts the transfer of the block. */
    icd_step_t burst;
    /** Value of the length in the burst telecommand. */
    uint32_t message_length;
    /** Whether the checksum of a block covers the padding of its last packet. */
    bool checksum_covers_fill;
    /** Counter of the index file, in addition to its type. */
    uint8_t index_counter;
    /** Time between two polls of the ready flag, in milliseconds. */
    uint32_t poll_interval;
    /** Longest time to load a block, in milliseconds. */
    uint32_t ready_timeout;
    /** Time without a new packet after which a burst has ended, in milliseconds. */
    uint32_t silence;
    /** Maximum number of bursts for one block. */
    uint32_t rounds;
    /** Maximum number of bytes of a file. */
    uint32_t max_bytes;
} icd_download_form_t;

/** Uploading a file. */
typedef struct {
    /** Erases the destination. */
    icd_step_t initiate;
    /** Reports that the destination is erased. */
    icd_step_t initiated;
    /** Begins a block. */
    icd_step_t begin;
    /** Contains a packet. */
    icd_step_t packet;
    /** Reports the checksum of the received block. */
    icd_step_t checksum;
    /** Commits a block. */
    icd_step_t finalize;
    /** Reports that the block is committed. */
    icd_step_t finalized;
    /** Value of the block size in `initiate`. */
    uint32_t block_size;
    /** Whether the checksum of a block covers the padding of its last packet. */
    bool checksum_covers_fill;
    /** Time between two polls of a busy flag, in milliseconds. */
    uint32_t poll_interval;
    /** Longest time to erase the destination, in milliseconds. */
    uint32_t erase_timeout;
    /** Longest time to commit a block, in milliseconds. */
    uint32_t finalize_timeout;
    /** Maximum number of rounds of packets for one block. */
    uint32_t rounds;
    /** Size of a destination in bytes, the maximum size of a file; 0 if the ICD does not say. */
    uint32_t destination_bytes;
    /** Supported destinations; empty if all are supported. */
    const uint8_t *destinations;
    /** Their number. */
    uint16_t destinations_count;
} icd_upload_form_t;

/** Erasing files, or formatting their medium. */
typedef struct {
    /** Starts the procedure. */
    icd_step_t request;
    /** Reports that it has ended. */
    icd_step_t progress;
    /** Time between two polls of the busy flag, in milliseconds. */
    uint32_t poll_interval;
    /** Longest duration, in milliseconds. */
    uint32_t timeout;
} icd_erase_form_t;

/** An operation on a stored program: a telecommand starts it, and a frame reports its end. */
typedef struct {
    /** Starts the operation. */
    icd_step_t request;
    /** Reports that it has ended. */
    icd_step_t progress;
    /** Time between two polls of that frame, in milliseconds. */
    uint32_t poll_interval;
    /** Longest duration, in milliseconds. */
    uint32_t timeout;
    /** Supported programs; empty if all are supported. */
    const uint8_t *programs;
    /** Their number. */
    uint16_t programs_count;
} icd_operation_form_t;

#endif /* ICDGEN_WIRE_PROCEDURE_FORMS_H */
