#ifndef ICDGEN_WIRE_EVENTS_C
#define ICDGEN_WIRE_EVENTS_C

#include "events.h"

static inline icd_event_t icdgen_event(icd_event_kind_t kind)
{
    icd_event_t event;
    (void)memset(&event, 0, sizeof event);
    event.kind = kind;
    return event;
}

static inline icd_event_t icdgen_event_of(icd_event_kind_t kind, uint32_t id)
{
    icd_event_t event = icdgen_event(kind);
    event.has_id = true;
    event.id = id;
    return event;
}

/* Return whether a time is reached. Times may wrap around. */
static inline bool icdgen_reached(uint32_t now, uint32_t time)
{
    return now - time < UINT32_C(0x80000000);
}

#endif /* ICDGEN_WIRE_EVENTS_C */
