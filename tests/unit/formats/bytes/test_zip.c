/* Tests the writer of ZIP archives: entries, equal bytes in each run, and sizes of 64 bits. */
#include "support/files/unzip.h"

#include "core/base/memory.h"
#include "formats/bytes/zip_write.h"

enum { BIG = 3 << 20 };

static cw_status write_archive(const char *path, bool huge, cw_error *err)
{
    static char big[BIG];
    cwi_outfile *file = NULL;
    memset(big, 'b', sizeof big);
    cw_status st = cwi_outfile_open(&file, path, false, err);
    cwi_zip z = {.file = file};
    if (st == CW_OK)
        st = cwi_zip_text(&z, "empty", "", err);
    if (st == CW_OK)
        st = cwi_zip_begin(&z, "folder/big", huge, err);
    for (size_t i = 0; st == CW_OK && i < BIG; i += BIG / 3)
        st = cwi_zip_put(&z, big + i, BIG / 3, err);
    if (st == CW_OK)
        st = cwi_zip_end(&z, err);
    if (st == CW_OK)
        st = cwi_zip_text(&z, "last", "some text", err);
    if (st == CW_OK)
        st = cwi_zip_finish(&z, err);
    if (st == CW_OK)
        st = cwi_outfile_commit(&file, err);
    cwi_zip_close(&z);
    cwi_outfile_abort(&file);
    return st;
}

static void entries_come_back(void **state)
{
    (void)state;
    for (int huge = 0; huge < 2; huge++) {
        cw_error err = {0};
        assert_ok(write_archive(test_path("a.zip"), huge, &err), err);
        char *text = unzip(test_path("a.zip"), "empty");
        assert_string_equal(text, "");
        free(text);
        text = unzip(test_path("a.zip"), "last");
        assert_string_equal(text, "some text");
        free(text);
        text = unzip(test_path("a.zip"), "folder/big");
        assert_int_equal(strlen(text), BIG);
        assert_true(text[0] == 'b' && text[BIG - 1] == 'b');
        free(text);
    }
}

static void two_runs_give_the_same_bytes(void **state)
{
    (void)state;
    cw_error err = {0};
    size_t size, again;
    assert_ok(write_archive(test_path("a.zip"), false, &err), err);
    assert_ok(write_archive(test_path("b.zip"), false, &err), err);
    char *a = test_file_read(test_path("a.zip"), &size);
    char *b = test_file_read(test_path("b.zip"), &again);
    assert_int_equal(size, again);
    assert_memory_equal(a, b, size);
    free(a);
    free(b);
}

/* Sizes beyond 32 bits are played: the sums are set behind the entry's back. */
static void sizes_of_64_bits_have_their_place(void **state)
{
    (void)state;
    const uint64_t size = (uint64_t)5 << 30, start = (uint64_t)6 << 30;
    cwi_outfile *file = NULL;
    cw_error err = {0};
    size_t length;
    assert_ok(cwi_outfile_open(&file, test_path("a.zip"), false, &err), err);
    cwi_zip z = {.file = file};
    assert_ok(cwi_zip_begin(&z, "x", false, &err), err);
    z.entries[0].size = size;
    assert_fails(cwi_zip_end(&z, &err), CW_ERR_LIMIT, "'x' in the archive has more than 4 GiB",
                 err);
    z.entries[0] = (cwi_zip_entry){.name = "x", .huge = true, .size = size, .packed = 7};
    z.entries[0].start = start;
    const uint64_t at = cwi_outfile_size(file);
    assert_ok(cwi_zip_finish(&z, &err), err);
    assert_ok(cwi_outfile_commit(&file, &err), err);
    char *bytes = test_file_read(test_path("a.zip"), &length);
    const char *record = bytes + at;
    assert_int_equal(number_at(record, 4), 0x02014b50);
    assert_int_equal(number_at(record + 6, 2), 45);
    assert_int_equal(number_at(record + 20, 4), UINT32_MAX);
    assert_int_equal(number_at(record + 24, 4), UINT32_MAX);
    assert_int_equal(number_at(record + 42, 4), UINT32_MAX);
    assert_int_equal(number_at(record + 47, 2), 1);
    assert_int_equal(number_at(record + 49, 2), 24);
    assert_int_equal(number_at(record + 51, 8), size);
    assert_int_equal(number_at(record + 59, 8), 7);
    assert_int_equal(number_at(record + 67, 8), start);
    free(bytes);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    bool failed = true;
    for (long n = 0; failed; n++) {
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = write_archive(test_path("a.zip"), false, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(test_folder_entries(), failed ? 0 : 1);
    }
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(entries_come_back),
        TEST(two_runs_give_the_same_bytes),
        TEST(sizes_of_64_bits_have_their_place),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
