/* Leases: files that tell other workers of a queue that a part is being made. */
#ifndef CLI_EXTRACT_PART_LEASE_H
#define CLI_EXTRACT_PART_LEASE_H

#include "cli/extract/part_manifest.h"

/* Seconds after which a lease that is not renewed counts no more: its worker is taken for dead. */
enum { CLI_LEASE_SECONDS = 60 };

/* A lease of this process. A zeroed one holds nothing. */
typedef struct cli_lease {
    char path[CLI_FRAGMENT_PATH];
    double renewed; /* by cli_seconds() */
} cli_lease;

/* Takes the lease of a part, counted from 0. Returns false where another worker has it. Two workers
 * that find an expired lease at once may both get it: they make the same bytes. */
bool cli_take_lease(const char *folder, size_t part, size_t parts, cli_lease *lease);

/* Renews a lease, some times in CLI_LEASE_SECONDS at most. */
void cli_renew_lease(cli_lease *lease);
void cli_drop_lease(cli_lease *lease);

/* Removes the lease of a part that is made, if its worker could not: it died. */
void cli_clear_lease(const char *folder, size_t part, size_t parts);

#endif
