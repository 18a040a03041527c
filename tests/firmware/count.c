/* A plugin of the emulator (interface version 1): counts the instructions executed between two addresses, and writes a line per count.
 *
 * Instructions are added up by blocks, which are executed from beginning to end, and the marks are functions, with which blocks begin. What the block of a mark
 * has added already is taken off, so that the count is exact. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The part of the emulator's interface that is used here. */
struct qemu_plugin_tb;
struct qemu_plugin_insn;
typedef void (*executed)(unsigned processor, void *data);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *, size_t);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *);
void qemu_plugin_register_vcpu_tb_trans_cb(uint64_t, void (*)(uint64_t, struct qemu_plugin_tb *));
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *, executed, int, void *);
void qemu_plugin_register_vcpu_tb_exec_inline(struct qemu_plugin_tb *, int, void *, uint64_t);
void qemu_plugin_register_atexit_cb(uint64_t, void (*)(uint64_t, void *), void *);

__attribute__((visibility("default"))) int qemu_plugin_version = 1;

static uint64_t executed_so_far, at_begin, begin_address, end_address;
static FILE *counts;

static void begin(unsigned processor, void *block) { at_begin = executed_so_far - (uintptr_t)block; }

static void end(unsigned processor, void *block) { fprintf(counts, "%" PRIu64 "\n", executed_so_far - (uintptr_t)block - at_begin); }

static void translated(uint64_t plugin, struct qemu_plugin_tb *block)
{
    size_t many = qemu_plugin_tb_n_insns(block);
    qemu_plugin_register_vcpu_tb_exec_inline(block, 0, &executed_so_far, many);
    for (size_t k = 0; k < many; k++) {
        struct qemu_plugin_insn *instruction = qemu_plugin_tb_get_insn(block, k);
        uint64_t address = qemu_plugin_insn_vaddr(instruction);
        void *rest = (void *)(uintptr_t)(many - k);
        if (address == begin_address)
            qemu_plugin_register_vcpu_insn_exec_cb(instruction, begin, 0, rest);
        else if (address == end_address)
            qemu_plugin_register_vcpu_insn_exec_cb(instruction, end, 0, rest);
    }
}

static void finished(uint64_t plugin, void *data) { fclose(counts); }

__attribute__((visibility("default"))) int qemu_plugin_install(uint64_t plugin, const void *emulator, int argc, char **argv)
{
    for (int k = 0; k < argc; k++) {
        char *value = strchr(argv[k], '=');
        if (value == NULL)
            continue;
        value++;
        if (strncmp(argv[k], "begin=", 6) == 0)
            begin_address = strtoull(value, NULL, 16) & ~UINT64_C(1);
        else if (strncmp(argv[k], "end=", 4) == 0)
            end_address = strtoull(value, NULL, 16) & ~UINT64_C(1);
        else if (strncmp(argv[k], "counts=", 7) == 0)
            counts = fopen(value, "w");
    }
    if (counts == NULL)
        return 1;
    qemu_plugin_register_vcpu_tb_trans_cb(plugin, translated);
    qemu_plugin_register_atexit_cb(plugin, finished, NULL);
    return 0;
}
