/*
 * Runs golden vectors of one firmware on a Cortex-M4 board that qemu emulates, and leaves by semihosting with the number of
 * vectors (at most 200) whose command or memory has other bits than wanted. Compiled by arm-none-eabi-gcc, for tests alone.
 */
#include "golden.h"

uint32_t wb_vectors_load(const uint8_t *bytes, uint32_t size);
uint32_t wb_vectors_set(const uint32_t *in);
uint32_t wb_vectors_step(const uint32_t *in);
uint32_t wb_vectors_get(uint32_t *out);
void reset(void);

static void leave(uint32_t status)
{
    const uint32_t block[2] = {0x20026u, status}; /* ADP_Stopped_ApplicationExit */
    register uint32_t operation __asm__("r0") = 0x20u; /* SYS_EXIT_EXTENDED */
    register const uint32_t *argument __asm__("r1") = block;
    __asm__ volatile("bkpt 0xAB" : : "r"(operation), "r"(argument) : "memory");
    for (;;) {
    }
}

void reset(void)
{
    static uint32_t after[STATES];
    uint32_t wrong = 0u;
    uint32_t i;
    uint32_t j;
    *(volatile uint32_t *)0xE000ED88u |= 0xF00000u; /* the floating-point unit on */
    __asm__ volatile("dsb\n isb");
    if (wb_vectors_load(image, sizeof image) != 0u) {
        leave(255u);
    }
    for (i = 0u; i < VECTORS; ++i) {
        uint32_t differs;
        (void)wb_vectors_set(states[i]);
        differs = (uint32_t)(wb_vectors_step(words[i]) != commands[i]);
        (void)wb_vectors_get(after);
        for (j = 0u; j < STATES; ++j) {
            differs |= (uint32_t)(after[j] != wanted[i][j]);
        }
        wrong += differs;
    }
    leave((wrong < 200u) ? wrong : 200u);
}

__attribute__((section(".vectors"), used)) static void (*const table[2])(void) = {(void (*)(void))0x20010000u, reset};
