/* Folders that appear at their path only when they are complete. */
#ifndef CORE_FILES_ATOMIC_FOLDER_H
#define CORE_FILES_ATOMIC_FOLDER_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An output folder. Its files go to a hidden folder beside the path; the commit puts that in
 * place of the old folder, which is then removed. Messages do not name the path. */
typedef struct cwi_outfolder cwi_outfolder;

/* Checks that an existing folder may be replaced, and everything in it removed. folder: open for
 * reading. Returns CW_ERR_OUTPUT for one that holds anything else. */
typedef cw_status cwi_folder_check(int folder, cw_error *err);

/* Creates the hidden folder. A link to a folder is followed. An empty folder is replaced
 * unchecked.
 *
 * no_clobber  fail when the path exists, here and again at the commit
 * check       of an existing folder, here and again at the commit
 * Returns     CW_ERR_OUTPUT  parent missing or not writable, path exists and no_clobber, path is
 *                            a file, or as check; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_outfolder_open(cwi_outfolder **out, const char *path,
                                          bool no_clobber, cwi_folder_check *check,
                                          cw_error *err);

/* Begins a file, after the one before was ended; a name such as "a/b" makes the folder a, too.
 * Errors of files are CW_ERR_OUTPUT. */
CW_NODISCARD cw_status cwi_outfolder_begin(cwi_outfolder *f, const char *name, cw_error *err);

/* Appends bytes to the file that was begun. */
CW_NODISCARD cw_status cwi_outfolder_write(cwi_outfolder *f, const void *bytes, size_t size,
                                           cw_error *err);

/* Flushes the file to the disk and closes it. */
CW_NODISCARD cw_status cwi_outfolder_end(cwi_outfolder *f, cw_error *err);

/* Writes a file at once. */
CW_NODISCARD cw_status cwi_outfolder_save(cwi_outfolder *f, const char *name, const void *bytes,
                                          size_t size, cw_error *err);

/* Returns the number of bytes of all files so far. */
uint64_t cwi_outfolder_size(const cwi_outfolder *f);

/* Puts the folder in its place. Frees and NULLs it, on failure too: the path then is unchanged
 * and nothing else is left. */
CW_NODISCARD cw_status cwi_outfolder_commit(cwi_outfolder **f, cw_error *err);

/* Removes the hidden folder, frees and NULLs. Harmless on NULL and after a commit. */
void cwi_outfolder_abort(cwi_outfolder **f);

/* Removes every hidden folder in progress. Async-signal-safe; cwi_outfile_remove_all() calls
 * it. */
void cwi_outfolder_remove_all(void);

#ifdef __cplusplus
}
#endif

#endif
