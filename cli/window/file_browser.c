/* Browses folders for files to open: folders first, with sizes and dates, filtered by what is
 * typed. A click chooses an entry, a second one opens it. */
#define _GNU_SOURCE /* strdup, strcasestr */
#include "cli/window/panels.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static void forget_entries(view_browser *b)
{
    for (size_t n = 0; n < b->count; n++)
        free(b->entries[n].name);
    free(b->entries);
    b->entries = NULL;
    b->count = 0;
    b->chosen[0] = '\0';
}

void view_close_browser(view *v)
{
    forget_entries(&v->widgets->browser);
}

/* Whether a name ends as those of a format that is read. DICOM's files need no extension. */
static bool has_known_extension(const char *name)
{
    size_t count;
    const cw_format *formats = cw_formats(&count);
    const size_t length = strlen(name);
    if (!strchr(name, '.'))
        return true;
    for (size_t n = 0; n < count; n++) {
        if (!formats[n].reads_volume && !formats[n].reads_mesh)
            continue;
        for (const char *e = formats[n].extensions; *e;) {
            const size_t size = strcspn(e, " ");
            if (size && length >= size && strncasecmp(name + length - size, e, size) == 0)
                return true;
            e += size + strspn(e + size, " ");
        }
    }
    return false;
}

static bool make_entry(const char *folder, const char *name, view_entry *entry)
{
    char path[2 * VIEW_PATH];
    struct stat info = {0};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    const bool is_there = stat(path, &info) == 0;
    *entry = (view_entry){.name = strdup(name),
                          .is_folder = is_there && S_ISDIR(info.st_mode),
                          .bytes = is_there ? (double)info.st_size : 0,
                          .time = info.st_mtime};
    entry->is_known = entry->is_folder || has_known_extension(name);
    return entry->name;
}

/* Folders come first. */
static void list_folder(view_browser *b)
{
    struct dirent **found;
    const int count = view_scan(b->folder, &found);
    forget_entries(b);
    view_entry *all = count > 0 ? calloc((size_t)count, sizeof *all) : NULL;
    b->entries = count > 0 ? calloc((size_t)count, sizeof *b->entries) : NULL;
    for (int n = 0; n < count && all && b->entries; n++)
        if (!make_entry(b->folder, found[n]->d_name, &all[n]))
            all[n].is_known = false;
    for (int folders = 1; folders >= 0; folders--)
        for (int n = 0; n < count && all && b->entries; n++)
            if (all[n].name && all[n].is_folder == (folders == 1))
                b->entries[b->count++] = all[n];
    if (!b->entries)
        for (int n = 0; n < count && all; n++)
            free(all[n].name);
    free(all);
    view_free_scan(found, count);
}

static void enter_folder(view_browser *b, const char *path)
{
    char whole[VIEW_PATH];
    if (!realpath(path, whole))
        return;
    snprintf(b->folder, sizeof b->folder, "%s", whole);
    snprintf(b->typed, sizeof b->typed, "%s", whole);
    b->filter[0] = '\0';
    list_folder(b);
}

static void enter_in_folder(view_browser *b, const char *name)
{
    char path[VIEW_PATH];
    const int length = snprintf(path, sizeof path, "%s/%s", b->folder, name);
    if (length > 0 && (size_t)length < sizeof path)
        enter_folder(b, path);
}

/* Begins in the folder of the file that is open, else where the program was started. */
static void begin_browsing(view *v)
{
    view_browser *b = &v->widgets->browser;
    char folder[VIEW_PATH];
    const char *slash = v->document.path ? strrchr(v->document.path, '/') : NULL;
    if (b->folder[0])
        return;
    snprintf(folder, sizeof folder, "%.*s",
             slash && slash != v->document.path ? (int)(slash - v->document.path) : 1,
             slash ? v->document.path : ".");
    enter_folder(b, folder);
}

static void open_and_close(view *v, const char *path)
{
    view_ask_open(v, path);
    v->shown.files = false;
}

static void open_entry(view *v, const view_entry *e)
{
    view_browser *b = &v->widgets->browser;
    char path[VIEW_PATH];
    const int length = snprintf(path, sizeof path, "%s/%s", b->folder, e->name);
    if (length < 0 || (size_t)length >= sizeof path)
        return;
    if (e->is_folder)
        enter_folder(b, path);
    else
        open_and_close(v, path);
}

/* A path that somebody typed: a folder is entered, a file is opened. */
static void open_typed(view *v)
{
    view_browser *b = &v->widgets->browser;
    struct stat info;
    if (stat(b->typed, &info) == 0 && S_ISDIR(info.st_mode))
        enter_folder(b, b->typed);
    else
        open_and_close(v, b->typed);
}

/* "12.3 MB  2026-01-31" */
static void describe_entry(const view_entry *e, char *text, size_t size)
{
    static const char *const units[] = {"B", "kB", "MB", "GB", "TB"};
    double bytes = e->bytes;
    char date[16] = "";
    size_t unit = 0;
    struct tm day;
    for (; bytes >= 1000 && unit < 4; unit++)
        bytes /= 1000;
    if (localtime_r(&e->time, &day))
        strftime(date, sizeof date, "%Y-%m-%d", &day);
    if (e->is_folder)
        snprintf(text, size, "%s", date);
    else
        snprintf(text, size, unit ? "%.1f %s  %s" : "%.0f %s  %s", bytes, units[unit], date);
}

static bool is_listed(const view_browser *b, const view_entry *e)
{
    return (b->shows_all || e->is_known) && (!b->filter[0] || strcasestr(e->name, b->filter));
}

/* Returns the entry to open, if one is clicked again. */
static const view_entry *show_entries(view *v)
{
    view_browser *b = &v->widgets->browser;
    const view_entry *opened = NULL;
    size_t listed = 0;
    for (size_t n = 0; n < b->count; n++) {
        const view_entry *e = &b->entries[n];
        char facts[64], name[VIEW_PATH];
        if (!is_listed(b, e))
            continue;
        listed++;
        describe_entry(e, facts, sizeof facts);
        snprintf(name, sizeof name, "%s%s", e->name, e->is_folder ? "/" : "");
        const bool is_chosen = strcmp(b->chosen, e->name) == 0;
        if (!v->ui->item(v->window, name, facts, is_chosen, true))
            continue;
        if (is_chosen || e->is_folder)
            opened = e;
        snprintf(b->chosen, sizeof b->chosen, "%s", e->name);
    }
    if (listed == 0)
        v->ui->text(v->window, b->count ? "Nothing here fits the filter." : "An empty folder.");
    return opened;
}

static void show_buttons(view *v)
{
    view_browser *b = &v->widgets->browser;
    if (v->ui->button(v->window, "Up"))
        enter_in_folder(b, "..");
    v->ui->same_line(v->window);
    if (v->ui->button(v->window, "Open the folder"))
        open_and_close(v, b->folder);
    v->ui->tip(v->window, "Open slices, or the steps of a time series");
    v->ui->same_line(v->window);
    v->ui->check(v->window, "All files", &b->shows_all);
    v->ui->tip(v->window, "List also files with extensions of no known format");
}

void view_browse(view *v)
{
    view_browser *b = &v->widgets->browser;
    const double scale = v->ui->scale(v->window);
    const cwi_ui_rect rect = {40 * scale, 50 * scale, 520 * scale,
                              fmax(120, (double)v->layout.height - 120 * scale)};
    const view_entry *opened = NULL;
    begin_browsing(v);
    if (v->ui->panel_begin(v->window, "Open", &rect, 0, &v->shown.files)) {
        if (v->ui->input(v->window, "Path", b->typed, sizeof b->typed))
            open_typed(v);
        v->ui->tip(v->window, "A file or a folder; press Enter");
        show_buttons(v);
        if (v->ui->input(v->window, "Filter", b->filter, sizeof b->filter))
            for (size_t n = 0; n < b->count && !opened; n++) /* Enter opens the first */
                opened = is_listed(b, &b->entries[n]) ? &b->entries[n] : NULL;
        v->ui->tip(v->window, "Part of a name; Enter opens the first file that is left");
        if (v->ui->section(v->window, "Recent", !v->document.path))
            view_show_recent(v);
        if (v->ui->section(v->window, "Folder", true)) {
            const view_entry *again = show_entries(v);
            opened = again ? again : opened;
        }
        if (opened)
            open_entry(v, opened);
    }
    v->ui->panel_end(v->window);
    if (!v->shown.files)
        b->folder[0] = '\0'; /* looked up again next time */
}
