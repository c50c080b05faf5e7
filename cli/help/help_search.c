/* Searches the options, commands, pages and view's verbs for the words of a query and their
 * synonyms. */
#include "cli/help/help_search.h"

#include "cli/framework/commands.h"
#include "cli/framework/option_rules.h"
#include "cli/session/view.h"
#include "core/base/status.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum {
    MAX_WORDS = 8,
    MAX_TERMS = 16, /* of a word: itself, and those of its synonyms */
    MAX_TEXT = 128,
    SHOWN_COMMANDS = 4, /* more are counted */
    SHOWN_HINTS = 3,    /* for a word that is no option or command */
    LONGER_BY = 5,      /* letters that a word may have more than a synonym of 4 or more */
};

/* A word of the query, and what it may stand for. */
typedef struct wish {
    char terms[MAX_TERMS][MAX_TEXT]; /* the first is the word */
    size_t count;
    const cli_synonym *synonym; /* NULL: none */
} wish;

typedef struct query {
    wish wishes[MAX_WORDS];
    size_t count;
} query;

/* --- the query ---------------------------------------------------------------------------- */

/* The next item of a list parted by '|', or NULL at its end. */
static const char *next_item(const char **list, char item[MAX_TEXT])
{
    if (!*list || !**list)
        return NULL;
    const size_t length = strcspn(*list, "|");
    snprintf(item, MAX_TEXT, "%.*s", (int)length, *list);
    *list += length + ((*list)[length] == '|');
    return item;
}

/* "decimation" is "decimat" and more; short words are taken as they are. */
static bool stands_for(const char *word, const char *item)
{
    const size_t length = strlen(item);
    if (strcasecmp(word, item) == 0)
        return true;
    if (length < 4 || strncasecmp(word, item, length) != 0 || strlen(word) > length + LONGER_BY)
        return false;
    for (const char *c = word + length; *c; c++)
        if (!isalpha((unsigned char)*c))
            return false;
    return true;
}

static const cli_synonym *find_synonym(const char *word)
{
    char item[MAX_TEXT];
    for (const cli_synonym *s = cli_synonyms; s->words; s++)
        for (const char *list = s->words; next_item(&list, item);)
            if (stands_for(word, item))
                return s;
    return NULL;
}

static void add_term(wish *w, const char *term)
{
    if (w->count < MAX_TERMS)
        snprintf(w->terms[w->count++], MAX_TEXT, "%s", term);
}

/* Adds a word with its synonyms. */
static void add_wish(query *q, const char *word, const cli_synonym *s)
{
    char item[MAX_TEXT];
    wish *w = &q->wishes[q->count++];
    w->synonym = s;
    add_term(w, word);
    for (const char *list = s ? s->terms : NULL; next_item(&list, item);)
        add_term(w, item);
}

/* Says which synonyms are followed. */
static void print_synonyms(const query *q)
{
    for (const wish *w = q->wishes; w < q->wishes + q->count; w++) {
        const cli_synonym *s = w->synonym;
        if (s && s->name && !stands_for(w->terms[0], s->name))
            printf("'%s' is called '%s' here.\n", w->terms[0], s->name);
        if (s && s->note)
            cli_print_wrapped(stdout, s->note, 0);
    }
}

/* A phrase of the table stands as one; else every word is looked for. */
static void parse_query(const char *text, query *q)
{
    char word[MAX_TEXT];
    const cli_synonym *whole = find_synonym(text);
    if (whole || !strchr(text, ' ')) {
        add_wish(q, text, whole);
        return;
    }
    while (*text && q->count < MAX_WORDS) {
        const size_t length = strcspn(text, " ");
        snprintf(word, sizeof word, "%.*s", (int)length, text);
        if (length)
            add_wish(q, word, find_synonym(word));
        text += length + (text[length] == ' ');
    }
}

/* --- matching ----------------------------------------------------------------------------- */

/* Blanks match any white space: pages are broken into lines. */
static bool begins_with(const char *text, const char *term)
{
    for (; *term; term++, text++)
        if (*term == ' ' ? !isspace((unsigned char)*text)
                         : tolower((unsigned char)*text) != tolower((unsigned char)*term))
            return false;
    return true;
}

static bool contains_term(const char *text, const char *term)
{
    for (; text && *text; text++)
        if (begins_with(text, term))
            return true;
    return false;
}

/* Subject of a search: an option by its name and its texts, a command by its texts alone. */
typedef struct subject {
    const char *option; /* NULL: not an option */
    const char *texts[3];
} subject;

static bool has_term(const subject *s, const char *term)
{
    if (strncmp(term, "--", 2) == 0)
        return s->option && strcmp(s->option, term + 2) == 0;
    for (size_t n = 0; n < 3; n++)
        if (contains_term(s->texts[n], term))
            return true;
    return contains_term(s->option, term);
}

static bool fits_query(const subject *s, const query *q)
{
    for (size_t w = 0; w < q->count; w++) {
        bool found = false;
        for (size_t t = 0; t < q->wishes[w].count && !found; t++)
            found = has_term(s, q->wishes[w].terms[t]);
        if (!found)
            return false;
    }
    return q->count > 0;
}

static bool option_fits(const cli_option *o, const query *q)
{
    return o->kind != CLI_HEADING && fits_query(&(subject){o->name, {o->value, o->about}}, q);
}

/* --- the results -------------------------------------------------------------------------- */

static bool is_same(const char *a, const char *b)
{
    return a == b || (a && b && strcmp(a, b) == 0);
}

/* The row of a command that is the same option: name, value and text; or NULL. */
static const cli_option *find_same(const cli_command *c, const cli_option *o)
{
    for (size_t n = 0; n < c->option_count; n++) {
        const cli_option *p = &c->options[n];
        if (p->kind == o->kind && is_same(p->name, o->name) && is_same(p->value, o->value) &&
            is_same(p->about, o->about))
            return p;
    }
    return NULL;
}

/* "extract, check, info and 5 more". */
static void print_commands(size_t first, const cli_option *o)
{
    size_t count = 0;
    for (size_t n = first; cli_commands[n]; n++)
        count += find_same(cli_commands[n], o) != NULL;
    const size_t shown = count > SHOWN_COMMANDS ? SHOWN_COMMANDS - 1 : count;
    size_t printed = 0;
    for (size_t n = first; cli_commands[n] && printed < shown; n++)
        if (find_same(cli_commands[n], o))
            printf("%s%s", printed++ ? ", " : "", cli_commands[n]->name);
    if (shown < count)
        printf(" and %zu more", count - shown);
}

static void print_found(const cli_command *c, const cli_option *o)
{
    printf(": --%s%s%s: %s\n", o->name, o->value ? " " : "", o->value ? o->value : "",
           c ? cli_option_about(c, o) : o->about);
}

/* Options that were not already printed with an earlier command. */
static size_t search_options(size_t command, const query *q)
{
    size_t found = 0;
    const cli_command *c = cli_commands[command];
    for (size_t n = 0; n < c->option_count; n++) {
        const cli_option *o = &c->options[n];
        bool is_new = option_fits(o, q);
        for (size_t k = 0; k < command && is_new; k++)
            is_new = !find_same(cli_commands[k], o);
        if (!is_new)
            continue;
        print_commands(command, o);
        print_found(c, o);
        found++;
    }
    return found;
}

static size_t search_commands(const query *q)
{
    size_t found = 0;
    for (size_t n = 0; cli_commands[n]; n++) {
        const cli_command *c = cli_commands[n];
        if (fits_query(&(subject){NULL, {c->name, c->about}}, q)) {
            printf("%s: %s\n", c->name, c->about);
            found++;
        }
    }
    return found;
}

/* Names the commands and topics whose page has the words; the page of help has words as
 * examples. */
static size_t search_pages(const query *q)
{
    size_t found = 0;
    for (size_t n = 0; cli_commands[n]; n++)
        if (cli_commands[n] != &cli_help &&
            fits_query(&(subject){NULL, {cli_commands[n]->page}}, q))
            printf("%s%s", found++ ? ", help " : "see also: help ", cli_commands[n]->name);
    for (const cli_topic *t = cli_topics; t->name; t++)
        if (t->page && fits_query(&(subject){NULL, {t->page}}, q))
            printf("%s%s", found++ ? ", help " : "see also: help ", t->name);
    if (found)
        putchar('\n');
    return found;
}

static size_t search_common(const query *q)
{
    size_t found = 0;
    for (size_t n = 0; n < cli_common_option_count; n++)
        if (option_fits(&cli_common_options[n], q)) {
            printf("every command");
            print_found(NULL, &cli_common_options[n]);
            found++;
        }
    return found;
}

/* Searches the commands that can be given inside view. */
static size_t search_verbs(const query *q)
{
    size_t found = 0;
    const view_verb *verb;
    for (size_t n = 0; (verb = view_verb_at(n)); n++)
        if (fits_query(&(subject){NULL, {verb->name, verb->about}}, q)) {
            printf("inside view: %s%s%s: %s\n", verb->name, *verb->takes ? " " : "",
                   verb->takes, verb->about);
            found++;
        }
    return found;
}

cw_status cli_search(const char *text, cw_error *err)
{
    query q = {0};
    parse_query(text, &q);
    print_synonyms(&q);
    size_t found = search_commands(&q);
    for (size_t n = 0; cli_commands[n]; n++)
        found += search_options(n, &q);
    found += search_common(&q);
    found += search_verbs(&q);
    found += search_pages(&q);
    return found ? CW_OK
                 : cwi_fail(err, CW_ERR_ARGUMENT,
                            "nothing in the help mentions '%s'; 'cubewright help' lists the "
                            "commands",
                            text);
}

/* --- a word that is no option or command -------------------------------------------------- */

/* Names that are found for a word, in a sentence: "--cut-plane, render --clip". */
typedef struct hints {
    const cli_command *own; /* whose options need no command before them; NULL: none */
    char names[SHOWN_HINTS][MAX_TEXT];
    const char *found[SHOWN_HINTS]; /* options and commands, by themselves */
    size_t count;
} hints;

/* Adds a command, or the option of one. Options that several others have are named once. */
static void add_hint(hints *h, const cli_command *c, const cli_option *o)
{
    const char *what = o ? o->name : c->name;
    for (size_t n = 0; n < h->count; n++)
        if (strcmp(h->found[n], what) == 0)
            return;
    if (h->count == SHOWN_HINTS)
        return;
    if (!o)
        snprintf(h->names[h->count], MAX_TEXT, "'%s'", what);
    else
        snprintf(h->names[h->count], MAX_TEXT, "%s%s--%s", c == h->own ? "" : c->name,
                 c == h->own ? "" : " ", what);
    h->found[h->count++] = what;
}

/* Adds the options of a command whose name is the term. */
static void add_named(hints *h, const cli_command *c, const char *term)
{
    const char *name = strncmp(term, "--", 2) == 0 ? term + 2 : term;
    for (size_t n = 0; n < c->option_count; n++)
        if (c->options[n].kind != CLI_HEADING && strcmp(c->options[n].name, name) == 0)
            add_hint(h, c, &c->options[n]);
}

/* Adds what the terms of a word name: options of the own command, else commands, else options of
 * others. */
static void add_terms(hints *h, const wish *w)
{
    for (size_t t = 0; t < w->count && h->own; t++)
        add_named(h, h->own, w->terms[t]);
    for (size_t t = 0; t < w->count && !(h->own && h->count); t++)
        for (size_t n = 0; cli_commands[n]; n++)
            if (cli_commands[n] != h->own && strcmp(cli_commands[n]->name, w->terms[t]) == 0)
                add_hint(h, cli_commands[n], NULL);
    for (size_t t = 0; t < w->count && !h->count; t++)
        for (size_t n = 0; cli_commands[n]; n++)
            add_named(h, cli_commands[n], w->terms[t]);
}

/* Adds options and commands whose text has the word: the own ones, else those of others. */
static void add_mentions(hints *h, const query *q)
{
    for (size_t n = 0; h->own && n < h->own->option_count; n++)
        if (option_fits(&h->own->options[n], q))
            add_hint(h, h->own, &h->own->options[n]);
    for (size_t n = 0; cli_commands[n] && !h->own; n++)
        if (fits_query(&(subject){NULL, {cli_commands[n]->name, cli_commands[n]->about}}, q))
            add_hint(h, cli_commands[n], NULL);
    for (size_t n = 0; cli_commands[n] && !h->count; n++)
        for (size_t k = 0; k < cli_commands[n]->option_count; k++)
            if (option_fits(&cli_commands[n]->options[k], q))
                add_hint(h, cli_commands[n], &cli_commands[n]->options[k]);
}

bool cli_search_word(const cli_command *command, const char *word, bool in_texts, char *names,
                     size_t size)
{
    query q = {0};
    hints h = {.own = command};
    size_t used = 0;
    parse_query(word, &q);
    if (q.count && !in_texts)
        add_terms(&h, &q.wishes[0]);
    else
        add_mentions(&h, &q);
    *names = '\0';
    for (size_t n = 0; n < h.count && used < size; n++)
        used += (size_t)snprintf(names + used, size - used, "%s%s",
                                 n == 0            ? ""
                                 : n + 1 < h.count ? ", "
                                                   : " and ",
                                 h.names[n]);
    return h.count > 0;
}
