/* The vector table of a Cortex-M; the rest of the start-up is newlib's, which talks to the host by semihosting. */

#include <stdint.h>

extern void _start(void);
extern uint32_t stack_top;

/* Ends the emulation: a fault must not look like a test that takes long. */
static void stop(void)
{
    register uint32_t call __asm__("r0") = 0x18;      /* SYS_EXIT */
    register uint32_t reason __asm__("r1") = 0x20023; /* run-time error */
    for (;;) {
        __asm__ volatile("bkpt 0xAB" : : "r"(call), "r"(reason) : "memory");
    }
}

static void reset(void)
{
#ifdef __ARM_FP
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* CPACR: the floating-point unit is off after a reset */
    __asm__ volatile("dsb\n\tisb");
#endif
    _start();
}

typedef void (*handler_t)(void);

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    handler_t handlers[15];
} vectors = {&stack_top, {reset, stop, stop, stop, stop, stop, 0, 0, 0, 0, stop, stop, 0, stop, stop}};
