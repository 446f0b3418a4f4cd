// Start of a Cortex-M4F without a library of C, and text through the debugger's semihosting.
#include <stdint.h>

extern uint32_t stack_top, data_start, data_end, data_source, bss_start, bss_end;
int main(void);

static intptr_t semihosting(intptr_t operation, const void *argument) {
    register intptr_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

// Console of the emulator, opened for writing.
void print(const char *text) {
    static const intptr_t opening[] = {(intptr_t)":tt", 4, 3};
    static intptr_t console = -1;
    intptr_t length = 0;
    if (console < 0) console = semihosting(0x01, opening);
    while (text[length]) length++;
    const intptr_t writing[] = {console, (intptr_t)text, length};
    semihosting(0x05, writing);
}

void leave(int failed) {
    // Stopped by the application: well, or by an error.
    for (;;) semihosting(0x18, (const void *)(intptr_t)(failed ? 0x20023 : 0x20026));
}

void reset(void) {
    // Coprocessors 10 and 11, the floating-point unit.
    *(volatile uint32_t *)0xE000ED88 |= 0xFu << 20;
    __asm__ volatile("dsb\n isb");
    for (uint32_t *at = &data_start, *from = &data_source; at < &data_end;) *at++ = *from++;
    for (uint32_t *at = &bss_start; at < &bss_end;) *at++ = 0;
    leave(main());
}

static void fault(void) { leave(1); }

__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    &stack_top, reset, fault, fault, fault, fault, fault,
};

__asm__(".section .rodata.page\n"
        ".global page, page_end\n"
        "page: .incbin \"page.bin\"\n"
        "page_end:\n"
        ".text\n");
