/* Makes a temporary folder with mkdtemp(), and removes it with the files in it. */
#define _GNU_SOURCE /* mkdtemp, strdup, unlinkat */
#include "cli/framework/temp_folder.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

cw_status cli_scratch_make(char **folder, cw_error *err)
{
    const char *base = getenv("TMPDIR");
    char path[4000];
    snprintf(path, sizeof path, "%s/cubewright-XXXXXX", base && *base ? base : "/tmp");
    if (!mkdtemp(path))
        return cwi_fail(err, CW_ERR_OUTPUT, "a temporary folder cannot be made in %s",
                        base && *base ? base : "/tmp");
    *folder = strdup(path);
    return *folder ? CW_OK : cwi_fail_memory(err);
}

void cli_scratch_remove(char *folder)
{
    DIR *dir = folder ? opendir(folder) : NULL;
    for (struct dirent *e; dir && (e = readdir(dir));)
        unlinkat(dirfd(dir), e->d_name, 0); /* of folders, such as "..", it takes none */
    if (dir)
        closedir(dir);
    if (folder)
        rmdir(folder);
    free(folder);
}
