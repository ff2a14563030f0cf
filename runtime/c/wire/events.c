#ifndef ICDGEN_WIRE_EVENTS_C
#define ICDGEN_WIRE_EVENTS_C

#include "events.h"

static inline icd_event_t icdgen_event(icd_event_kind_t kind, uint8_t id)
{
    icd_event_t event;
    (void)memset(&event, 0, sizeof event);
    event.kind = kind;
    event.id = id;
    event.code = -1;
    event.parameter = -1;
    return event;
}

/* Return whether a time is reached. Times may wrap around. */
static inline bool icdgen_reached(uint32_t now, uint32_t time)
{
    return now - time < UINT32_C(0x80000000);
}

#endif /* ICDGEN_WIRE_EVENTS_C */
