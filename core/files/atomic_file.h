/* Files that appear at their path only when they are complete. */
#ifndef CORE_FILES_ATOMIC_FILE_H
#define CORE_FILES_ATOMIC_FILE_H

#include <cubewright/core.h>

#include <limits.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An output file. Bytes go to a hidden temporary beside the path; the commit renames it over
 * the old file. Until then the path keeps its old file in any case. Messages do not name the
 * path: the caller puts it in front. */
typedef struct cwi_outfile cwi_outfile;

/* Creates the temporary. A link to a regular file is followed, and the real file replaced.
 *
 * no_clobber  fail when the path exists, here and again, race-free, at the commit
 * Returns     CW_ERR_OUTPUT  folder missing or not writable, path exists and no_clobber, path
 *                            is a folder, device or the like; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_outfile_open(cwi_outfile **out, const char *path, bool no_clobber,
                                        cw_error *err);

/* Opens an output on an empty file that has no name, such as one in memory. Its commit leaves the
 * bytes there, and flushes no disk.
 *
 * fd         borrowed: the output has a copy of it
 * in_memory  its bytes count for cw_memory_limit() until it is committed or aborted
 * Returns    CW_ERR_OUTPUT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_outfile_open_at(cwi_outfile **out, int fd, bool in_memory,
                                           cw_error *err);

/* Appends bytes; buffered. Returns CW_ERR_OUTPUT when they cannot be written. Later writes and
 * the commit then fail with the same message. */
CW_NODISCARD cw_status cwi_outfile_write(cwi_outfile *f, const void *bytes, size_t size,
                                         cw_error *err);

/* Appends text; numbers have a decimal point in any locale. */
CW_NODISCARD cw_status cwi_outfile_printf(cwi_outfile *f, cw_error *err, const char *format,
                                          ...) CW_PRINTF(3, 4);

/* Leaves a gap of bytes, which another process writes. Same errors as cwi_outfile_write(). */
CW_NODISCARD cw_status cwi_outfile_skip(cwi_outfile *f, uint64_t size, cw_error *err);

/* Returns the name of the temporary, without its folder; and opens the one of that name which
 * another process created for the same path. It writes, and leaves its gaps to others. Its commit
 * flushes to the disk and renames nothing: that process does. */
const char *cwi_outfile_temporary(const cwi_outfile *f);
CW_NODISCARD cw_status cwi_outfile_join(cwi_outfile **out, const char *path,
                                        const char *temporary, cw_error *err);

/* Returns the number of bytes appended so far. */
uint64_t cwi_outfile_size(const cwi_outfile *f);

/* Writes over bytes that were appended before, for values known only later, such as sizes. The
 * next bytes are appended as before. Same errors as cwi_outfile_write(). */
CW_NODISCARD cw_status cwi_outfile_patch(cwi_outfile *f, uint64_t at, const void *bytes,
                                         size_t size, cw_error *err);

/* Flushes to the disk and closes, so that all that is left of the commit is the rename. Later
 * writes fail. Same errors as the commit. */
CW_NODISCARD cw_status cwi_outfile_finish(cwi_outfile *f, cw_error *err);

/* Flushes to the disk and renames. Frees and NULLs the file, on failure too: the temporary is
 * then removed and the path unchanged. */
CW_NODISCARD cw_status cwi_outfile_commit(cwi_outfile **f, cw_error *err);

/* Removes the temporary, frees and NULLs. Harmless on NULL and after a commit. */
void cwi_outfile_abort(cwi_outfile **f);

/* Writes a whole file at once; errors name the path. CW_ERR_OUTPUT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_outfile_save(const char *path, const void *bytes, size_t size,
                                        cw_error *err);

/* Unlinks every temporary in progress, folders too; the program then has to exit.
 * Async-signal-safe: for a second Ctrl-C. Covers the first 64 files and 8 folders that are open
 * at one time. */
void cwi_outfile_remove_all(void);

/* Does the same, and makes threads that open another file wait for the end of the program: for a
 * thread that ends it while the others work. */
void cwi_outfile_end_all(void);

#ifdef __cplusplus
}
#endif

#endif
