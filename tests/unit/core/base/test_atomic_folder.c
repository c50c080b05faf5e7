/* Tests atomic folders: the old one stays until the commit, foreign files are never removed, and
 * nothing is left behind. */
#define _GNU_SOURCE /* symlink */
#include "support/support.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/files/atomic_file.h"
#include "core/files/atomic_folder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Lets folders with a file "ours" be replaced. */
static cw_status check_ours(int folder, cw_error *err)
{
    return faccessat(folder, "ours", F_OK, 0) == 0
               ? CW_OK
               : cwi_fail(err, CW_ERR_OUTPUT, "it is not one of ours");
}

static cw_status open_folder(cwi_outfolder **f, const char *name, bool no_clobber,
                             cw_error *err)
{
    return cwi_outfolder_open(f, test_path(name), no_clobber, check_ours, err);
}

static cw_status write_folder(const char *name, const char *text, bool no_clobber,
                              cw_error *err)
{
    cwi_outfolder *f = NULL;
    cw_status st = open_folder(&f, name, no_clobber, err);
    if (st == CW_OK)
        st = cwi_outfolder_save(f, "ours", text, strlen(text), err);
    if (st == CW_OK)
        st = cwi_outfolder_save(f, "inner/file", "x", 1, err);
    if (st == CW_OK)
        assert_int_equal(cwi_outfolder_size(f), strlen(text) + 1);
    if (st == CW_OK)
        st = cwi_outfolder_commit(&f, err);
    cwi_outfolder_abort(&f);
    assert_null(f);
    return st;
}

static void assert_holds(const char *path, const char *text)
{
    size_t size;
    char *bytes = test_file_read(path, &size);
    assert_string_equal(bytes, text);
    free(bytes);
}

static void a_folder_appears_whole_and_replaces_its_kind(void **state)
{
    (void)state;
    cw_error err = {0};
    assert_ok(write_folder("a", "first", false, &err), err);
    assert_holds(test_path("a/ours"), "first");
    assert_ok(write_folder("a/", "second", false, &err), err);
    assert_holds(test_path("a/ours"), "second");
    assert_holds(test_path("a/inner/file"), "x");
    assert_int_equal(test_folder_entries(), 1);
    assert_int_equal(mkdir(test_path("empty"), 0777), 0);
    assert_ok(write_folder("empty", "third", false, &err), err);
    assert_int_equal(symlink("a", test_path("link")), 0);
    assert_ok(write_folder("link", "linked", false, &err), err);
    assert_holds(test_path("a/ours"), "linked");
    struct stat info;
    assert_int_equal(lstat(test_path("link"), &info), 0);
    assert_true(S_ISLNK(info.st_mode));
}

static void other_things_are_refused_and_stay(void **state)
{
    (void)state;
    cw_error err = {0};
    cwi_outfolder *f = NULL;
    test_file_write(test_path("file"), "text", 4);
    assert_fails(write_folder("file", "x", false, &err), CW_ERR_OUTPUT, "is a file", err);
    assert_int_equal(mkdir(test_path("b"), 0777), 0);
    test_file_write(test_path("b/theirs"), "text", 4);
    assert_fails(write_folder("b", "x", false, &err), CW_ERR_OUTPUT, "not one of ours", err);
    assert_holds(test_path("b/theirs"), "text");
    assert_fails(write_folder("no/b", "x", false, &err), CW_ERR_OUTPUT, "does not exist", err);
    assert_ok(write_folder("c", "first", false, &err), err);
    assert_fails(write_folder("c", "x", true, &err), CW_ERR_OUTPUT, "exists", err);
    /* what came in the meantime is judged as well */
    assert_ok(open_folder(&f, "d", true, &err), err);
    assert_int_equal(mkdir(test_path("d"), 0777), 0);
    assert_fails(cwi_outfolder_commit(&f, &err), CW_ERR_OUTPUT, "exists", err);
    assert_int_equal(test_folder_entries(), 4);
}

static void nothing_is_left_behind(void **state)
{
    (void)state;
    cw_error err = {0};
    cwi_outfolder *f = NULL;
    assert_ok(write_folder("a", "old", false, &err), err);
    assert_ok(open_folder(&f, "a", false, &err), err);
    char name[32];
    for (int i = 0; i < 500; i++) { /* more than one call lists */
        snprintf(name, sizeof name, "a-rather-long-name-%d", i);
        assert_ok(cwi_outfolder_save(f, name, "x", 1, &err), err);
    }
    assert_ok(cwi_outfolder_save(f, "in/file", "x", 1, &err), err);
    assert_ok(cwi_outfolder_begin(f, "open", &err), err);
    assert_int_equal(test_folder_entries(), 2);
    cwi_outfile_remove_all();
    assert_int_equal(test_folder_entries(), 1);
    cwi_outfolder_abort(&f);
    assert_ok(open_folder(&f, "a", false, &err), err);
    assert_ok(cwi_outfolder_begin(f, "open", &err), err);
    assert_fails(cwi_outfolder_save(f, "open", "x", 1, &err), CW_ERR_OUTPUT, "cannot be made",
                 err);
    cwi_outfolder_abort(&f);
    assert_int_equal(test_folder_entries(), 1);
    assert_holds(test_path("a/ours"), "old");
}

static void memory_that_runs_out_is_told(void **state)
{
    (void)state;
    for (long n = 0;; n++) {
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = write_folder("a", "x", false, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            break;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
        assert_int_equal(test_folder_entries(), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#define TEST(f) cmocka_unit_test_setup_teardown(f, test_folder_make, test_folder_remove)
        TEST(a_folder_appears_whole_and_replaces_its_kind),
        TEST(other_things_are_refused_and_stay),
        TEST(nothing_is_left_behind),
        TEST(memory_that_runs_out_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
