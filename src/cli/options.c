/* SPDX-License-Identifier: Apache-2.0
 *
 * The command line by the table of options: parsing, range checks, defaults, help, the manifest.
 */
#include "option_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_choice(const char *choices, const char *text)
{
    size_t length = strlen(text);
    for (const char *at = choices; length && at; at = strchr(at, '|')) {
        at += *at == '|';
        if (strncmp(at, text, length) == 0 && (at[length] == '|' || at[length] == 0)) return true;
    }
    return false;
}

/* Stores the value; NULL, or what is wrong with it. */
static const char *store(cli_values *values, const cli_option *o, const char *text)
{
    void *field = (char *)values + o->offset;
    if (o->kind == FLAG) *(bool *)field = true;
    if (o->kind == CHOICE && !is_choice(o->value, text)) return "must be one of";
    if (o->kind == TEXT && !text[0]) return "must not be empty:";
    if (o->kind == CHOICE || o->kind == TEXT) *(const char **)field = text;
    if (o->kind != WHOLE && o->kind != REAL) return NULL;
    char *end = NULL;
    double x = strtod(text, &end);
    if (end == text || *end || !isfinite(x)) return "must be a number:";
    if (o->kind == WHOLE && x != floor(x)) return "must be a whole number:";
    if (x < o->low || x > o->high) return "is out of range:";
    *(double *)field = x;
    return NULL;
}

/* The command's own, where commands have options of one name with different values. */
static const cli_option *find_long(const char *name, size_t length, unsigned command)
{
    const cli_option *found = NULL;
    for (size_t i = 0; i < cli_option_count; i++) {
        const cli_option *o = &cli_options[i];
        if (strlen(o->name) != length || strncmp(o->name, name, length) != 0) continue;
        if (!found || (o->commands & command)) found = o;
    }
    return found;
}

static const cli_option *find_letter(char letter)
{
    for (size_t i = 0; i < cli_option_count; i++)
        if (cli_options[i].letter && cli_options[i].letter == letter) return &cli_options[i];
    return NULL;
}

static bool say_unknown(const cli_command *command, const char *word)
{
    const char *names[CLI_MAX_OPTIONS + 1], *nearest = NULL;
    size_t count = 0;
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(word + 2, "="),
             word[1] == '-' ? word + 2 : "");
    for (size_t i = 0; i < cli_option_count && count < CLI_MAX_OPTIONS; i++)
        if (cli_options[i].commands & command->bit) names[count++] = cli_options[i].name;
    names[count] = NULL;
    if (name[0]) nearest = cli_nearest(name, names);
    if (nearest)
        fprintf(stderr, "igi: %s: there is no such option; did you mean --%s?\n", word, nearest);
    else
        fprintf(stderr, "igi: %s: there is no such option; see igi help %s\n", word, command->name);
    return false;
}

/* Reads one option at argv[*at] and moves *at past its value. */
static bool parse_option(cli_session *s, int argc, char **argv, int *at)
{
    const char *word = argv[*at], *value = NULL;
    const cli_option *o;
    if (word[1] == '-') {
        size_t length = strcspn(word + 2, "=");
        o = find_long(word + 2, length, s->command->bit);
        if (word[2 + length] == '=') value = word + 3 + length;
    } else {
        o = find_letter(word[1]);
        if (word[2]) value = word + 2;
    }
    if (!o || !(o->commands & s->command->bit)) return say_unknown(s->command, word);
    if (o->kind == FLAG && value) {
        fprintf(stderr, "igi: %s: --%s takes no value\n", word, o->name);
        return false;
    }
    if (o->kind != FLAG && !value) {
        if (*at + 1 >= argc) {
            fprintf(stderr, "igi: %s: its value is missing: %s\n", word, o->value);
            return false;
        }
        value = argv[++*at];
    }
    const char *wrong = store(&s->values, o, value);
    if (!wrong) return true;
    fprintf(stderr, "igi: --%s '%s': %s %s", o->name, value, wrong, o->value);
    if (o->kind == WHOLE || o->kind == REAL)
        fprintf(stderr, " from %.16g to %.16g", o->low, o->high);
    fputs("\n", stderr);
    return false;
}

bool cli_parse(cli_session *s, int argc, char **argv)
{
    bool only_arguments = false;
    for (size_t i = 0; i < cli_option_count; i++)
        if (cli_options[i].standard)
            (void)store(&s->values, &cli_options[i], cli_options[i].standard);
    for (int at = 0; at < argc; at++) {
        const char *word = argv[at];
        if (only_arguments || word[0] != '-' || !word[1]) {
            if (s->argument_count == CLI_MAX_ARGUMENTS) {
                fprintf(stderr, "igi: %s: more than %d arguments\n", word, CLI_MAX_ARGUMENTS);
                return false;
            }
            s->arguments[s->argument_count++] = word;
        } else if (strcmp(word, "--") == 0) {
            only_arguments = true;
        } else if (!parse_option(s, argc, argv, &at)) {
            return false;
        }
    }
    int given = s->argument_count, needed = s->command->arguments;
    if (s->values.help || given == needed || (s->command->more && given > needed)) return true;
    fprintf(stderr, "igi: %s: %d argument%s given, %d%s needed: igi %s\n", s->command->name, given,
            given == 1 ? "" : "s", needed, s->command->more ? " or more" : "", s->command->usage);
    return false;
}

void cli_each_option(unsigned command, cli_option_fn print)
{
    for (size_t i = 0; i < cli_option_count; i++) {
        const cli_option *o = &cli_options[i];
        if (!(o->commands & command)) continue;
        char names[128];
        snprintf(names, sizeof names, "%s%c%s --%s%s%s", o->letter ? "-" : " ",
                 o->letter ? o->letter : ' ', o->letter ? "," : " ", o->name, o->value ? " " : "",
                 o->value ? o->value : "");
        print(names, o->help, o->standard);
    }
}

size_t cli_settings(const cli_session *s, igi_setting *settings, char text[][32], size_t room)
{
    size_t count = 0;
    for (size_t i = 0; i < cli_option_count && count < room; i++) {
        const cli_option *o = &cli_options[i];
        if (!(o->commands & s->command->bit) || o->kind == FLAG) continue;
        const void *field = (const char *)&s->values + o->offset;
        settings[count] = (igi_setting){o->name, text[count]};
        if (o->kind == TEXT || o->kind == CHOICE)
            settings[count].value = *(const char *const *)field;
        else snprintf(text[count], 32, "%.16g", *(const double *)field);
        count += settings[count].value != NULL;
    }
    return count;
}
