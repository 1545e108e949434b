/* SPDX-License-Identifier: Apache-2.0
 *
 * Tables, JSON and the quoted command line.
 */
#include "cli.h"

#include <math.h>
#include <string.h>

static bool needs_quotes(const char *word)
{
    static const char safe[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=:,+@%-";
    return !word[0] || word[strspn(word, safe)];
}

void cli_command_line(const cli_session *s, char *text, size_t size)
{
    size_t at = 0;
    for (int i = 0; i < s->argc && at + 8 < size; i++) {
        const char *word = i == 0 ? "igi" : s->argv[i];
        bool quoted = needs_quotes(word);
        if (i) text[at++] = ' ';
        if (quoted) text[at++] = '\'';
        for (; *word && at + 8 < size; word++) {
            if (*word == '\'') at += (size_t)snprintf(text + at, 5, "'\\''");
            else text[at++] = *word;
        }
        if (quoted) text[at++] = '\'';
    }
    text[at] = 0;
}

void cli_print_json_string(const char *text)
{
    putchar('"');
    for (; *text; text++) {
        unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\') printf("\\%c", c);
        else if (c < 32) printf("\\u%04x", c);
        else putchar(c);
    }
    putchar('"');
}

void cli_print_json_number(double x)
{
    if (isfinite(x)) printf("%.6g", x);
    else printf("null");
}

void cli_print_json_field(const char *name, double x)
{
    printf(", \"%s\": ", name);
    cli_print_json_number(x);
}

bool cli_begin_written(const cli_session *s, const char *path)
{
    if (!s->values.json) return false;
    fputs("{\"output\": ", stdout);
    cli_print_json_string(path);
    return true;
}

void cli_print_percent(double fraction, int width)
{
    if (!isfinite(fraction)) printf("%*s", width, "-");
    else
        printf("%*.*f %%", width - 2,
               fabs(fraction) < .00995  ? 3
               : fabs(fraction) < 9.995 ? 2
                                        : 0,
               100 * fraction);
}

int cli_text_width(const char *text)
{
    int width = 0;
    for (; *text; text++) width += ((unsigned char)*text & 0xc0) != 0x80; /* UTF-8: leading bytes */
    return width;
}

void cli_print_padded(const char *text, int width)
{
    printf("%s%*s", text, width > cli_text_width(text) ? width - cli_text_width(text) : 0, "");
}

const char *cli_file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}
