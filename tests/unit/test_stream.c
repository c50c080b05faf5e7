#define _GNU_SOURCE /* memfd_create */
#include "formats/stream.h"
#include "support/reading.h"

#include <sys/mman.h>
#include <unistd.h>

enum { SIZE = 300000 };
static unsigned char plain[SIZE];

/* Compresses badly, so that there are many buffers of it. */
static void fill_plain(void)
{
    uint32_t x = 1;
    for (size_t i = 0; i < SIZE; i++) {
        x = x * 1664525u + 1013904223u;
        plain[i] = (unsigned char)(x >> 24 & 0x3f);
    }
}

static int make_file(const void *bytes, size_t size)
{
    const int fd = memfd_create("stream", MFD_CLOEXEC);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, bytes, size), size);
    return fd;
}

static cw_status read_all(int fd, uint64_t offset, bool deflated, unsigned char *to,
                          size_t size, cw_error *err)
{
    cwi_stream s = {0};
    cw_status st = cwi_stream_open(&s, fd, offset, deflated, err);
    for (size_t done = 0; st == CW_OK && done < size; done += 1000)
        st = cwi_stream_read(&s, to + done, size - done < 1000 ? size - done : 1000, err);
    if (st == CW_OK)
        st = cwi_stream_finish(&s, err);
    cwi_stream_close(&s);
    return st;
}

static void bytes_arrive_as_they_were(void **state)
{
    (void)state;
    static unsigned char back[SIZE];
    for (int kind = 0; kind < 3; kind++) { /* plain, zlib, gzip */
        cw_error err = {0};
        size_t size = SIZE;
        unsigned char *packed = kind ? pack_bytes(plain, SIZE, kind == 2, &size) : NULL;
        const int fd = make_file(packed ? packed : plain, size);
        memset(back, 0, SIZE);
        assert_ok(read_all(fd, 0, kind > 0, back, SIZE, &err), err);
        assert_memory_equal(back, plain, SIZE);
        close(fd);
        free(packed);
    }
}

static void gzip_members_in_a_row_are_one_stream(void **state)
{
    (void)state;
    static unsigned char back[SIZE];
    cw_error err = {0};
    size_t first, second;
    unsigned char *a = pack_bytes(plain, 100001, true, &first);
    unsigned char *b = pack_bytes(plain + 100001, SIZE - 100001, true, &second);
    unsigned char *both = malloc(first + second);
    assert_non_null(both);
    memcpy(both, a, first);
    memcpy(both + first, b, second);
    const int fd = make_file(both, first + second);
    assert_ok(read_all(fd, 0, true, back, SIZE, &err), err);
    assert_memory_equal(back, plain, SIZE);
    close(fd);
    free(a), free(b), free(both);
}

static void short_data_say_how_many_bytes_were_there(void **state)
{
    (void)state;
    unsigned char back[100];
    cw_error err = {0};
    const int fd = make_file(plain, 60);
    assert_fails(read_all(fd, 20, false, back, 100, &err), CW_ERR_FORMAT,
                 "wanted 100 bytes from byte 0 on, there were 40", err);
    close(fd);
}

/* Every cut, and a flip in every byte behind the gzip header, is found out by the decoder, the
 * length or the checksum; but for the padding bits, which change nothing. */
static void no_damage_goes_unnoticed(void **state)
{
    (void)state;
    enum { SMALL = 500, GZIP_HEADER = 10 };
    unsigned char back[SMALL];
    cw_error err = {0};
    size_t size;
    unsigned char *packed = pack_bytes(plain, SMALL, true, &size);
    for (size_t cut = 0; cut < size; cut++) {
        const int fd = make_file(packed, cut);
        assert_int_equal(read_all(fd, 0, true, back, SMALL, &err), CW_ERR_FORMAT);
        close(fd);
    }
    for (size_t i = GZIP_HEADER; i < size; i++) {
        packed[i] ^= 0x10;
        const int fd = make_file(packed, size);
        if (read_all(fd, 0, true, back, SMALL, &err) == CW_OK)
            assert_memory_equal(back, plain, SMALL);
        close(fd);
        packed[i] ^= 0x10;
    }
    free(packed);
}

/* Padding ends a piece, not the text; blanks may stand anywhere; portions may have any size. */
static void base64_text_gives_its_bytes(void **state)
{
    (void)state;
    static const char text[] = "\n Zm9v YmE=\tZg==Zm9v\nYmFy</x>Zm9v";
    static const char wanted[] = "foobaffoobar";
    for (size_t portion = 1; portion <= sizeof wanted; portion++) {
        char back[sizeof wanted] = "";
        size_t done = 0, got = 1;
        cw_error err = {0};
        cwi_stream s = {0};
        const int fd = make_file(text, sizeof text - 1);
        assert_ok(cwi_stream_open(&s, fd, 0, false, &err), err);
        assert_ok(cwi_stream_from_base64(&s, &err), err);
        for (; got > 0; done += got) {
            const size_t room = sizeof back - done;
            assert_ok(
                cwi_stream_some(&s, back + done, portion < room ? portion : room, &got, &err),
                err);
        }
        assert_int_equal(done, sizeof wanted - 1);
        assert_string_equal(back, wanted);
        cwi_stream_close(&s);
        close(fd);
    }
}

static void what_is_no_base64_is_told_by_its_place(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } cases[] = {
        {"Zm9v*m9v", "byte 4 of the file is not base64"},
        {"Zm9vZ===", "byte 5 of the file is not base64"},
        {"Zm9vZm=v", "byte 7 of the file is not base64"},
        {"Zm9vZm9", "there were 5"},
        {"Zm9v<m9v", "there were 3"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char back[6];
        cw_error err = {0};
        cwi_stream s = {0};
        const int fd = make_file(cases[i].text, strlen(cases[i].text));
        assert_ok(cwi_stream_open(&s, fd, 0, false, &err), err);
        assert_ok(cwi_stream_from_base64(&s, &err), err);
        assert_fails(cwi_stream_read(&s, back, 6, &err), CW_ERR_FORMAT, cases[i].words, err);
        cwi_stream_close(&s);
        close(fd);
    }
}

static void nothing_behind_its_end_is_read(void **state)
{
    (void)state;
    char back[4];
    size_t got;
    cw_error err = {0};
    cwi_stream s = {0};
    const int fd = make_file("abcdef", 6);
    assert_ok(cwi_stream_open(&s, fd, 1, false, &err), err);
    cwi_stream_end_at(&s, 3);
    assert_ok(cwi_stream_some(&s, back, 4, &got, &err), err);
    assert_int_equal(got, 2);
    assert_memory_equal(back, "bc", 2);
    cwi_stream_close(&s);
    close(fd);
}

static void a_wrong_checksum_is_named(void **state)
{
    (void)state;
    unsigned char back[500];
    cw_error err = {0};
    size_t size;
    unsigned char *packed = pack_bytes(plain, 500, true, &size);
    packed[size - 5] ^= 1;
    packed[size - 8] ^= 1;
    const int fd = make_file(packed, size);
    assert_fails(read_all(fd, 0, true, back, 500, &err), CW_ERR_FORMAT, "incorrect data check",
                 err);
    close(fd);
    free(packed);
}

static void a_long_tail_is_left_unread(void **state)
{
    (void)state;
    unsigned char back[500];
    cw_error err = {0};
    size_t size;
    unsigned char *packed = pack_bytes(plain, SIZE, true, &size);
    const int fd = make_file(packed, size - 8); /* without its checksum */
    assert_ok(read_all(fd, 0, true, back, 500, &err), err);
    assert_memory_equal(back, plain, 500);
    close(fd);
    free(packed);
}

static void skipping_lands_where_reading_would(void **state)
{
    (void)state;
    unsigned char back[10];
    cw_error err = {0};
    for (int deflated = 0; deflated < 2; deflated++) {
        size_t size = SIZE;
        cwi_stream s;
        unsigned char *packed = deflated ? pack_bytes(plain, SIZE, true, &size) : NULL;
        const int fd = make_file(packed ? packed : plain, size);
        assert_ok(cwi_stream_open(&s, fd, 0, deflated, &err), err);
        assert_ok(cwi_stream_skip(&s, 123456, &err), err);
        assert_ok(cwi_stream_read(&s, back, sizeof back, &err), err);
        assert_memory_equal(back, plain + 123456, sizeof back);
        cwi_stream_close(&s);
        cwi_stream_close(&s);
        close(fd);
        free(packed);
    }
}

static void a_stream_without_memory_says_so(void **state)
{
    (void)state;
    for (long n = 0; n < 2; n++) {
        cwi_stream s;
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        cw_status st = cwi_stream_open(&s, -1, 0, true, &err);
        cwi_alloc_fail_after(-1);
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory to inflate", err);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bytes_arrive_as_they_were),
        cmocka_unit_test(gzip_members_in_a_row_are_one_stream),
        cmocka_unit_test(short_data_say_how_many_bytes_were_there),
        cmocka_unit_test(no_damage_goes_unnoticed),
        cmocka_unit_test(base64_text_gives_its_bytes),
        cmocka_unit_test(what_is_no_base64_is_told_by_its_place),
        cmocka_unit_test(nothing_behind_its_end_is_read),
        cmocka_unit_test(a_wrong_checksum_is_named),
        cmocka_unit_test(a_long_tail_is_left_unread),
        cmocka_unit_test(skipping_lands_where_reading_would),
        cmocka_unit_test(a_stream_without_memory_says_so),
    };
    fill_plain();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
