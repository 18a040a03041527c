/* The surroundings of the program on a board in the emulator: vectors, start, and semihosting for its output. */
#include <stdint.h>

int program(void);

extern uint32_t data_from[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];

/* Asks the emulator for a service. */
static int32_t ask(int32_t what, const void *with)
{
    register int32_t r0 __asm__("r0") = what;
    register const void *r1 __asm__("r1") = with;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

/* Writes to the standard output: the file ":tt", opened for writing. */
void say(const char *text)
{
    static int32_t output = -1;
    uint32_t length = 0;
    if (output < 0) {
        const uintptr_t name[3] = {(uintptr_t) ":tt", 4, 3};
        output = ask(0x01, name);
    }
    while (text[length] != 0)
        length++;
    const uintptr_t data[3] = {(uintptr_t)output, (uintptr_t)text, length};
    ask(0x05, data);
}

/* Compilers may call these; there is no C library here. */
void *memset(void *to, int value, unsigned long count)
{
    for (volatile unsigned char *at = to; count > 0; count--)
        *at++ = (unsigned char)value;
    return to;
}

void *memcpy(void *to, const void *from, unsigned long count)
{
    volatile unsigned char *at = to;
    for (const unsigned char *of = from; count > 0; count--)
        *at++ = *of++;
    return to;
}

void reset(void)
{
    /* The floating-point unit is off after a reset. */
    *(volatile uint32_t *)0xe000ed88 |= 0xfu << 20;
    __asm__ volatile("dsb\nisb");
    for (uint32_t *from = data_from, *to = data_begin; to < data_end;)
        *to++ = *from++;
    for (uint32_t *to = bss_begin; to < bss_end;)
        *to++ = 0;
    /* ADP_Stopped_ApplicationExit, or a run-time error. */
    ask(0x18, (const void *)(uintptr_t)(program() == 0 ? 0x20026 : 0x20023));
    for (;;) {
    }
}

/* A fault ends the emulation with an error. */
static void fault(void)
{
    ask(0x18, (const void *)0x20023);
    for (;;) {
    }
}

__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    stack_top, reset, fault, fault, fault, fault, fault,
};
