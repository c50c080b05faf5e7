/* Tests atomic files: an old file stays until the commit, links, modes, full disks, and bytes
 * synced before the name. */
#define _GNU_SOURCE /* mkfifo, symlink, setrlimit, syscall */
#include "support/support.h"

#include "core/base/memory.h"
#include "core/files/atomic_file.h"

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MAX_SYNCS = 4 };

/* One call of fsync(): of what, and how far the file was by then. */
typedef struct sync_call {
    bool of_folder, is_in_place; /* the path names the file that was synced last */
    off_t size;
} sync_call;

static struct {
    const char *path;       /* of the file that is written */
    int failure[MAX_SYNCS]; /* errno of each call; 0: it succeeds */
    sync_call calls[MAX_SYNCS];
    int count;
    ino_t file;
} syncs;

static void watch_syncs(const char *path)
{
    memset(&syncs, 0, sizeof syncs);
    syncs.path = path;
}

/* Stands in front of the system's: the library calls what the program defines. */
int fsync(int fd)
{
    struct stat info, named;
    if (!syncs.path || syncs.count == MAX_SYNCS || fstat(fd, &info) != 0)
        return (int)syscall(SYS_fsync, fd);
    sync_call *call = &syncs.calls[syncs.count];
    call->of_folder = S_ISDIR(info.st_mode);
    if (!call->of_folder)
        syncs.file = info.st_ino;
    call->size = info.st_size;
    call->is_in_place = stat(syncs.path, &named) == 0 && named.st_ino == syncs.file;
    errno = syncs.failure[syncs.count++];
    return errno ? -1 : (int)syscall(SYS_fsync, fd);
}

static cw_status write_file(const char *path, const char *text, bool no_clobber, cw_error *err)
{
    cwi_outfile *file = NULL;
    cw_status st = cwi_outfile_open(&file, path, no_clobber, err);
    if (st == CW_OK)
        st = cwi_outfile_write(file, text, strlen(text), err);
    if (st == CW_OK)
        st = cwi_outfile_commit(&file, err);
    cwi_outfile_abort(&file);
    return st;
}

static void assert_holds(const char *path, const char *text)
{
    size_t size;
    char *bytes = test_file_read(path, &size);
    assert_string_equal(bytes, text);
    free(bytes);
}

static unsigned mode_of(const char *path)
{
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    return info.st_mode & 0777;
}

static void a_file_appears_only_at_the_commit(void **state)
{
    (void)state;
    const char *path = test_path("a.bin");
    cwi_outfile *file = NULL;
    cw_error err = {0};
    assert_ok(cwi_outfile_open(&file, path, false, &err), err);
    assert_ok(cwi_outfile_write(file, "whole", 5, &err), err);
    assert_int_not_equal(access(path, F_OK), 0);
    assert_int_equal(test_folder_entries(), 1); /* the temporary */
    assert_ok(cwi_outfile_commit(&file, &err), err);
    assert_null(file);
    assert_holds(path, "whole");
    assert_int_equal(test_folder_entries(), 1);
}

static void an_old_file_stays_until_the_commit(void **state)
{
    (void)state;
    const char *path = test_path("old.bin");
    cwi_outfile *file = NULL;
    cw_error err = {0};
    test_file_write(path, "old", 3);
    assert_ok(cwi_outfile_open(&file, path, false, &err), err);
    assert_ok(cwi_outfile_write(file, "new", 3, &err), err);
    assert_holds(path, "old");
    assert_ok(cwi_outfile_commit(&file, &err), err);
    assert_holds(path, "new");
}

static void an_abort_leaves_nothing_and_can_be_repeated(void **state)
{
    (void)state;
    cwi_outfile *file = NULL;
    cw_error err = {0};
    assert_ok(cwi_outfile_open(&file, test_path("a.bin"), false, &err), err);
    assert_ok(cwi_outfile_write(file, "half", 4, &err), err);
    cwi_outfile_abort(&file);
    cwi_outfile_abort(&file);
    assert_null(file);
    assert_int_equal(test_folder_entries(), 0);
}

static void buffered_and_large_writes_keep_their_order(void **state)
{
    (void)state;
    enum { SIZE = 3 << 20 };
    const char *path = test_path("large.bin");
    unsigned char *bytes = malloc(SIZE);
    assert_non_null(bytes);
    for (size_t i = 0; i < SIZE; i++)
        bytes[i] = (unsigned char)(i * 2654435761u >> 13);
    cwi_outfile *file = NULL;
    cw_error err = {0};
    assert_ok(cwi_outfile_open(&file, path, false, &err), err);
    size_t at = 0;
    for (size_t step = 1; at < SIZE; step = step * 3 + 1) {
        const size_t n = step < SIZE - at ? step : SIZE - at;
        assert_ok(cwi_outfile_write(file, bytes + at, n, &err), err);
        at += n;
    }
    assert_ok(cwi_outfile_commit(&file, &err), err);
    size_t size;
    char *back = test_file_read(path, &size);
    assert_int_equal(size, SIZE);
    assert_memory_equal(back, bytes, SIZE);
    free(back);
    free(bytes);
}

static void printed_text_may_be_longer_than_the_buffer(void **state)
{
    (void)state;
    enum { LENGTH = 300000 };
    const char *path = test_path("text");
    char *text = malloc(LENGTH + 1);
    assert_non_null(text);
    memset(text, 'x', LENGTH);
    text[LENGTH] = '\0';
    cwi_outfile *file = NULL;
    cw_error err = {0};
    assert_ok(cwi_outfile_open(&file, path, false, &err), err);
    assert_ok(cwi_outfile_printf(file, &err, "%d %.2f ", 7, 1.25), err);
    assert_ok(cwi_outfile_printf(file, &err, "%s|", text), err);
    assert_ok(cwi_outfile_printf(file, &err, "end"), err);
    assert_ok(cwi_outfile_commit(&file, &err), err);
    size_t size;
    char *back = test_file_read(path, &size);
    assert_int_equal(size, 7 + LENGTH + 4);
    assert_memory_equal(back, "7 1.25 x", 8);
    assert_string_equal(back + size - 5, "x|end");
    free(back);
    free(text);
}

/* The byte that would end the string needs room too, though it is not written. */
static void printed_text_may_end_with_the_buffer(void **state)
{
    (void)state;
    enum { BUFFER = 256 * 1024 }; /* as the file's own */
    static char bytes[BUFFER];
    const char *path = test_path("text");
    memset(bytes, '.', sizeof bytes);
    for (size_t before = BUFFER - 6; before <= BUFFER; before++) {
        cwi_outfile *file = NULL;
        cw_error err = {0};
        size_t size;
        assert_ok(cwi_outfile_open(&file, path, false, &err), err);
        assert_ok(cwi_outfile_write(file, bytes, before, &err), err);
        assert_ok(cwi_outfile_printf(file, &err, "%d", 1234), err);
        assert_ok(cwi_outfile_printf(file, &err, "|"), err);
        assert_ok(cwi_outfile_commit(&file, &err), err);
        char *back = test_file_read(path, &size);
        assert_int_equal(size, before + 5);
        assert_string_equal(back + before - 1, ".1234|");
        free(back);
    }
}

static void what_was_written_may_be_written_over(void **state)
{
    (void)state;
    const char *path = test_path("patched");
    static char bytes[600000];
    cwi_outfile *file = NULL;
    cw_error err = {0};
    size_t size;
    memset(bytes, '.', sizeof bytes);
    assert_ok(cwi_outfile_open(&file, path, false, &err), err);
    assert_int_equal(cwi_outfile_size(file), 0);
    assert_ok(cwi_outfile_printf(file, &err, "size: %s\n", "????"), err);
    assert_int_equal(cwi_outfile_size(file), 11);
    assert_ok(cwi_outfile_patch(file, 6, "1234", 4, &err), err);
    assert_ok(cwi_outfile_write(file, bytes, sizeof bytes, &err), err);
    assert_ok(cwi_outfile_write(file, "end", 3, &err), err);
    assert_int_equal(cwi_outfile_size(file), sizeof bytes + 14);
    assert_ok(cwi_outfile_patch(file, sizeof bytes + 10, "|END", 4, &err), err);
    assert_ok(cwi_outfile_patch(file, 0, "S", 1, &err), err);
    assert_ok(cwi_outfile_printf(file, &err, "."), err);
    assert_ok(cwi_outfile_commit(&file, &err), err);
    char *back = test_file_read(path, &size);
    assert_int_equal(size, sizeof bytes + 15);
    assert_memory_equal(back, "Size: 1234\n...", 14);
    assert_string_equal(back + size - 7, "..|END.");
    free(back);
}

static void numbers_have_points_in_every_locale(void **state)
{
    (void)state;
    if (!setlocale(LC_ALL, "de_DE.UTF-8"))
        skip();
    cwi_outfile *file = NULL;
    cw_error err = {0};
    assert_ok(cwi_outfile_open(&file, test_path("n"), false, &err), err);
    assert_ok(cwi_outfile_printf(file, &err, "%g", 0.5), err);
    assert_ok(cwi_outfile_commit(&file, &err), err);
    setlocale(LC_ALL, "C");
    assert_holds(test_path("n"), "0.5");
}

/* Every kind of thing at the path beforehand, as one row each. */
static void only_regular_files_are_replaced(void **state)
{
    (void)state;
    cw_error err = {0};
    assert_int_equal(mkdir(test_path("folder"), 0777), 0);
    assert_int_equal(mkfifo(test_path("pipe"), 0666), 0);
    assert_int_equal(symlink("nowhere", test_path("dangling")), 0);
    test_file_write(test_path("file"), "x", 1);
    static const struct {
        const char *name, *words;
    } rows[] = {
        {"folder", "it is a folder"},
        {"folder/", "it is a folder"},
        {"pipe", "it is a device, pipe or socket"},
        {"dangling", "a link that leads nowhere"},
        {"new/", "it names no file"},
        {"file/a", "cannot be opened: Not a directory"},
        {"missing/a", "missing' does not exist"},
        {"missing/b/a", "missing/b' does not exist"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        assert_fails(write_file(test_path(rows[i].name), "x", false, &err), CW_ERR_OUTPUT,
                     rows[i].words, err);
    assert_fails(write_file("/dev/null", "x", false, &err), CW_ERR_OUTPUT, "device", err);
    assert_fails(write_file("", "x", false, &err), CW_ERR_OUTPUT, "it names no file", err);
    assert_int_equal(test_folder_entries(), 4);
}

static void a_link_is_followed_and_stays_a_link(void **state)
{
    (void)state;
    cw_error err = {0};
    struct stat info;
    assert_int_equal(mkdir(test_path("real"), 0777), 0);
    test_file_write(test_path("real/file"), "old", 3);
    assert_int_equal(symlink("real/file", test_path("link")), 0);
    assert_ok(write_file(test_path("link"), "new", false, &err), err);
    assert_int_equal(lstat(test_path("link"), &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    assert_holds(test_path("real/file"), "new");
    assert_fails(write_file(test_path("link"), "x", true, &err), CW_ERR_OUTPUT, "it exists",
                 err);
}

static void no_clobber_refuses_what_was_there_and_what_came_meanwhile(void **state)
{
    (void)state;
    const char *path = test_path("kept");
    cwi_outfile *file = NULL;
    cw_error err = {0};
    assert_ok(write_file(path, "first", true, &err), err);
    assert_fails(write_file(path, "second", true, &err), CW_ERR_OUTPUT, "it exists", err);
    assert_holds(path, "first");

    const char *late = test_path("late");
    assert_ok(cwi_outfile_open(&file, late, true, &err), err);
    test_file_write(late, "faster", 6);
    assert_fails(cwi_outfile_commit(&file, &err), CW_ERR_OUTPUT, "it exists", err);
    assert_null(file);
    assert_holds(late, "faster");
    assert_int_equal(test_folder_entries(), 2);
}

static void modes_follow_the_umask_or_the_old_file(void **state)
{
    (void)state;
    cw_error err = {0};
    const mode_t before = umask(027);
    assert_ok(write_file(test_path("new"), "x", false, &err), err);
    assert_int_equal(mode_of(test_path("new")), 0640);
    assert_int_equal(chmod(test_path("new"), 0606), 0);
    assert_ok(write_file(test_path("new"), "y", false, &err), err);
    assert_int_equal(mode_of(test_path("new")), 0606);
    umask(before);
}

static void the_longest_name_can_be_written(void **state)
{
    (void)state;
    cw_error err = {0};
    char name[257];
    memset(name, 'n', sizeof name);
    name[255] = '\0';
    char path[512];
    snprintf(path, sizeof path, "%s", test_path(name)); /* test_path cuts at 255 bytes */
    const size_t folder = (size_t)(strrchr(path, '/') - path) + 1;
    snprintf(path + folder, sizeof path - folder, "%s", name);
    assert_ok(write_file(path, "x", false, &err), err);
    assert_holds(path, "x");
    name[255] = 'n';
    name[256] = '\0';
    snprintf(path + folder, sizeof path - folder, "%s", name);
    assert_fails(write_file(path, "x", false, &err), CW_ERR_OUTPUT, "too long", err);
}

/* After a crash the name stands for the old file or for the whole new one: the bytes are on the
 * disk before the name is, and the name is when the call returns. */
static void bytes_reach_the_disk_before_their_name_does(void **state)
{
    (void)state;
    const char *path = test_path("synced");
    cw_error err = {0};
    for (int round = 0; round < 3; round++) { /* a new file, a replaced one, no_clobber */
        if (round == 2)
            assert_int_equal(unlink(path), 0);
        watch_syncs(path);
        assert_ok(write_file(path, "whole", round == 2, &err), err);
        syncs.path = NULL;
        assert_int_equal(syncs.count, 2);
        assert_false(syncs.calls[0].of_folder);
        assert_false(syncs.calls[0].is_in_place);
        assert_int_equal(syncs.calls[0].size, 5);
        assert_true(syncs.calls[1].of_folder);
        assert_true(syncs.calls[1].is_in_place);
    }
}

/* A disk that fails keeps the old file; a file system that cannot sync is no failure, nor is
 * a signal, nor a folder that stays unsynced. */
static void only_a_failing_disk_refuses_the_file(void **state)
{
    (void)state;
    static const struct {
        int failure[3];
        int calls;
        bool is_written;
    } rows[] = {
        {{EIO}, 1, false},     {{ENOSPC}, 1, false},         {{EINTR, EIO}, 2, false},
        {{EINVAL}, 2, true},   {{ENOTSUP}, 2, true},         {{EROFS}, 2, true},
        {{EINTR, 0}, 3, true}, {{EINTR, EINTR, 0}, 4, true}, {{0, EIO}, 2, true},
    };
    const char *path = test_path("kept");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        cw_error err = {0};
        test_file_write(path, "old", 3);
        watch_syncs(path);
        memcpy(syncs.failure, rows[i].failure, sizeof rows[i].failure);
        const cw_status st = write_file(path, "new", false, &err);
        syncs.path = NULL;
        assert_int_equal(syncs.count, rows[i].calls);
        if (rows[i].is_written)
            assert_ok(st, err);
        else
            assert_fails(st, CW_ERR_OUTPUT, "cannot be flushed to the disk", err);
        assert_holds(path, rows[i].is_written ? "new" : "old");
        assert_int_equal(test_folder_entries(), 1);
    }
}

/* A full disk is played by a limit on the size of files. The child has its own limit. */
static int write_too_much(const char *path)
{
    const struct rlimit limit = {4096, 4096};
    static char bytes[600000];
    cwi_outfile *file = NULL;
    cw_error err = {0}, later = {0};
    signal(SIGXFSZ, SIG_IGN);
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0 ||
        cwi_outfile_open(&file, path, false, &err) != CW_OK)
        return 1;
    if (cwi_outfile_write(file, bytes, sizeof bytes, &err) != CW_ERR_OUTPUT ||
        !strstr(err.message, "File too large"))
        return 2;
    if (cwi_outfile_printf(file, &later, "x") != CW_ERR_OUTPUT ||
        cwi_outfile_patch(file, 0, "x", 1, &later) != CW_ERR_OUTPUT ||
        cwi_outfile_commit(&file, &later) != CW_ERR_OUTPUT || file)
        return 3;
    return strcmp(err.message, later.message) == 0 ? 0 : 4;
}

static void a_full_disk_fails_and_keeps_the_old_file(void **state)
{
    (void)state;
    const char *path = test_path("full");
    int status;
    test_file_write(path, "old", 3);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
        _exit(write_too_much(path));
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_holds(path, "old");
    assert_int_equal(test_folder_entries(), 1);
}

static void a_signal_handler_can_remove_what_is_in_progress(void **state)
{
    (void)state;
    cwi_outfile *files[70] = {0}; /* more than the registry holds: those are only not removed */
    cw_error err = {0};
    char name[16];
    for (int i = 0; i < 70; i++) {
        snprintf(name, sizeof name, "f%d", i);
        assert_ok(cwi_outfile_open(&files[i], test_path(name), i == 1, &err), err);
    }
    assert_int_equal(test_folder_entries(), 70);
    cwi_outfile_remove_all();
    assert_int_equal(test_folder_entries(), 6);
    for (int i = 0; i < 2; i++) /* the second one must not replace anything */
        assert_fails(cwi_outfile_commit(&files[i], &err), CW_ERR_OUTPUT, "put in its place",
                     err);
    for (int i = 0; i < 70; i++)
        cwi_outfile_abort(&files[i]);
    assert_int_equal(test_folder_entries(), 0);
    assert_ok(write_file(test_path("after"), "x", false, &err), err);
    cwi_outfile_remove_all();
    assert_holds(test_path("after"), "x");
}

static void running_out_of_memory_leaves_nothing(void **state)
{
    (void)state;
    cw_error err = {0};
    long n = 0;
    for (bool failed = true; failed; n++) {
        cwi_alloc_fail_after(n);
        cw_status st = write_file(test_path("m"), "x", false, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(test_folder_entries(), failed ? 0 : 1);
    }
    assert_true(n > 2);
}

#define CASE(test) cmocka_unit_test_setup_teardown(test, test_folder_make, test_folder_remove)

/* Of a name that memory ran out for, there is nothing. */
static void no_name_is_no_file(void **state)
{
    (void)state;
    cwi_outfile *f;
    cw_error err = {0};
    assert_fails(cwi_outfile_open(&f, NULL, false, &err), CW_ERR_NO_MEMORY, "no memory", err);
    assert_null(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(no_name_is_no_file),
        CASE(a_file_appears_only_at_the_commit),
        CASE(an_old_file_stays_until_the_commit),
        CASE(an_abort_leaves_nothing_and_can_be_repeated),
        CASE(buffered_and_large_writes_keep_their_order),
        CASE(printed_text_may_be_longer_than_the_buffer),
        CASE(printed_text_may_end_with_the_buffer),
        CASE(what_was_written_may_be_written_over),
        CASE(numbers_have_points_in_every_locale),
        CASE(only_regular_files_are_replaced),
        CASE(a_link_is_followed_and_stays_a_link),
        CASE(no_clobber_refuses_what_was_there_and_what_came_meanwhile),
        CASE(modes_follow_the_umask_or_the_old_file),
        CASE(the_longest_name_can_be_written),
        CASE(bytes_reach_the_disk_before_their_name_does),
        CASE(only_a_failing_disk_refuses_the_file),
        CASE(a_full_disk_fails_and_keeps_the_old_file),
        CASE(a_signal_handler_can_remove_what_is_in_progress),
        CASE(running_out_of_memory_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
