/* Takes, renews and drops leases of parts. A lease is a file that only one worker can create; its
 * text names the worker's machine and process, and its time is that of the last renewal. */
#define _GNU_SOURCE /* futimens, gethostname */
#include "cli/extract/part_lease.h"

#include "cli/framework/console.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { HOST_BYTES = 256 };

static void name_host(char host[HOST_BYTES])
{
    if (gethostname(host, HOST_BYTES) != 0)
        host[0] = '\0';
    host[HOST_BYTES - 1] = '\0';
}

static bool create_lease(const char *path)
{
    char host[HOST_BYTES];
    const int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0)
        return false;
    name_host(host);
    dprintf(file, "%s %ld\n", host, (long)getpid());
    close(file);
    return true;
}

/* Returns true if the worker of a lease is on this machine, and has ended. */
static bool is_dead(const char *path)
{
    char here[HOST_BYTES], host[HOST_BYTES];
    long pid = 0;
    FILE *file = fopen(path, "r");
    const bool read = file && fscanf(file, "%255s %ld", host, &pid) == 2;
    if (file)
        fclose(file);
    name_host(here);
    return read && pid > 0 && strcmp(host, here) == 0 && kill((pid_t)pid, 0) != 0 &&
           errno == ESRCH;
}

static bool is_expired(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 &&
           (difftime(time(NULL), info.st_mtime) > CLI_LEASE_SECONDS || is_dead(path));
}

static bool name_lease(const char *folder, size_t part, size_t parts,
                       char path[CLI_FRAGMENT_PATH])
{
    return snprintf(path, CLI_FRAGMENT_PATH, "%s/part-%zu-of-%zu.lease", folder, part + 1,
                    parts) < CLI_FRAGMENT_PATH;
}

bool cli_take_lease(const char *folder, size_t part, size_t parts, cli_lease *lease)
{
    *lease = (cli_lease){.renewed = cli_seconds()};
    if (!name_lease(folder, part, parts, lease->path))
        return false;
    if (create_lease(lease->path))
        return true;
    if (errno != EEXIST || !is_expired(lease->path))
        return false;
    unlink(lease->path);
    return create_lease(lease->path);
}

void cli_renew_lease(cli_lease *lease)
{
    if (!lease->path[0] || cli_seconds() - lease->renewed < CLI_LEASE_SECONDS / 12)
        return;
    lease->renewed = cli_seconds();
    utimensat(AT_FDCWD, lease->path, NULL, 0);
}

void cli_drop_lease(cli_lease *lease)
{
    if (lease->path[0])
        unlink(lease->path);
    *lease = (cli_lease){0};
}

void cli_clear_lease(const char *folder, size_t part, size_t parts)
{
    char path[CLI_FRAGMENT_PATH];
    if (name_lease(folder, part, parts, path) && is_expired(path))
        unlink(path);
}
