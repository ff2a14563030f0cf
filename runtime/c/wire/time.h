#ifndef ICDGEN_WIRE_TIME_H
#define ICDGEN_WIRE_TIME_H

#include "../icdgen.h"
#include "linkage.h"
#include "forms.h"
#include "link.h"

/* ---- packed time ------------------------------------------------------------------------------------------------- */

/** A date and time of day. */
typedef struct {
    uint16_t year;
    uint16_t month;
    uint16_t day;
    uint16_t hour;
    uint16_t minute;
    uint16_t second;
} icd_dos_time_t;

/** Return the name of the first invalid part, such as "month"; NULL if the date and time are valid. */
ICDGEN_API const char *icd_dos_time_wrong(const icd_dos_time_t *time);

/** Unpack a time without checking it. Use icd_dos_time_wrong() to check it. */
ICDGEN_API icd_status_t icd_dos_time_unpack(const icd_link_t *link, uint32_t value, icd_dos_time_t *time);

/**
 * Pack a time, rounded down to the resolution of the format. Return ICD_ERROR_RANGE, and set `wrong` to the name of the
 * first part that is invalid or does not fit.
 */
ICDGEN_API icd_status_t
icd_dos_time_pack(const icd_link_t *link, const icd_dos_time_t *time, uint32_t *value, const char **wrong);

#endif /* ICDGEN_WIRE_TIME_H */
