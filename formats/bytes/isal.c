/* Inflates gzip and zlib data by ISA-L, behind an interface like zlib's inflate(). */
#include "formats/bytes/isal.h"

#include "core/base/memory.h"

#include <isa-l/igzip_lib.h>

typedef struct inflater {
    bool begun; /* a member was begun; its first byte decides its kind */
    struct inflate_state isal;
} inflater;

bool cwi_isal_open(void **state)
{
    *state = cwi_alloc_zeroed(1, sizeof(inflater));
    return *state;
}

static char *text_of(int code)
{
    switch (code) {
    case ISAL_INCORRECT_CHECKSUM:
        return "incorrect data check";
    case ISAL_INVALID_WRAPPER:
    case ISAL_UNSUPPORTED_METHOD:
        return "incorrect header check";
    case ISAL_INVALID_BLOCK:
        return "invalid block";
    case ISAL_INVALID_SYMBOL:
        return "invalid code";
    default:
        return "invalid distance";
    }
}

static void begin_member(inflater *f, unsigned char first)
{
    isal_inflate_init(&f->isal);
    f->isal.crc_flag = first == 0x1f ? ISAL_GZIP : ISAL_ZLIB;
    f->begun = true;
}

/* Ends a member. Whole bytes that ISA-L read too far are given back: up to eight, before
 * next_in. */
static void end_member(inflater *f)
{
    const uint32_t ahead = (uint32_t)f->isal.read_in_length / 8;
    f->isal.next_in -= ahead;
    f->isal.avail_in += ahead;
    f->begun = false;
}

int cwi_isal_inflate(void *state, z_stream *z)
{
    inflater *f = state;
    if (!f->begun && !z->avail_in)
        return Z_BUF_ERROR;
    if (!f->begun)
        begin_member(f, z->next_in[0]);
    f->isal.next_in = (uint8_t *)(uintptr_t)z->next_in;
    f->isal.avail_in = z->avail_in;
    f->isal.next_out = z->next_out;
    f->isal.avail_out = z->avail_out;
    const int code = isal_inflate(&f->isal);
    const bool ended = code == ISAL_DECOMP_OK && f->isal.block_state == ISAL_BLOCK_FINISH;
    if (ended)
        end_member(f);
    z->next_in = f->isal.next_in;
    z->avail_in = f->isal.avail_in;
    z->next_out = f->isal.next_out;
    z->avail_out = f->isal.avail_out;
    if (code == ISAL_DECOMP_OK)
        return ended ? Z_STREAM_END : Z_OK;
    if (code == ISAL_NEED_DICT)
        return Z_NEED_DICT;
    z->msg = text_of(code);
    return Z_DATA_ERROR;
}
