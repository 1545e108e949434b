/* SPDX-License-Identifier: Apache-2.0
 *
 * Help from the tables of commands and options: on the terminal, and as the manual page igi(1).
 */
#include "cli.h"

#include <string.h>

void cli_print_overview(void)
{
    printf("igi %s: inverse global illumination. What a room is made of, from photographs.\n\n"
           "usage: igi COMMAND ...\n\n",
           igi_version());
    for (const cli_command *const *c = cli_commands; *c; c++)
        printf("  igi %-38s %s\n", (*c)->usage, (*c)->summary);
    puts("\nTo begin: igi check SCENE, then igi recover SCENE -o OUT, then look at "
         "OUT/report.html.\n"
         "igi help COMMAND explains a command; man igi has it all.");
}

enum { COLUMN = 31, COLUMNS = 90 }; /* where the text of options begins, and ends */

/* Words of the text from `at` on; returns where the last one ends. */
static int print_words(const char *text, int at)
{
    while (*text) {
        int length = (int)strcspn(text, " ");
        if (at + 1 + length > COLUMNS && at > COLUMN) {
            printf("\n%*s", COLUMN, "");
            at = COLUMN;
        }
        at += printf(at > COLUMN ? " %.*s" : "%.*s", length, text);
        text += length;
        text += strspn(text, " ");
    }
    return at;
}

static void print_option(const char *names, const char *help, const char *standard)
{
    printf("  %-28s ", names);
    if (strlen(names) > 28) printf("\n%*s", COLUMN, "");
    int at = print_words(help, COLUMN);
    if (standard) {
        char text[128];
        snprintf(text, sizeof text, "[%s]", standard);
        print_words(text, at);
    }
    puts("");
}

void cli_print_help(const cli_command *command)
{
    printf("usage: igi %s\n\n%s\n\nexample: %s\n\n%s\n\noptions:\n", command->usage,
           command->summary, command->example, command->details);
    cli_each_option(command->bit, print_option);
    puts("\nexit status: 0 done; 1 it ran, and the answer is no; 2 usage; 3 input data; 4 file\n"
         "system or memory; 5 a fault of igi's own; 130 interrupted");
}

/* Text for troff: minus signs that stay minus signs, lines that do not become requests. */
static void print_roff(const char *text)
{
    bool line_begins = true;
    for (; *text; text++) {
        if (line_begins && (*text == '.' || *text == '\'')) fputs("\\&", stdout);
        if (*text == '-') fputs("\\-", stdout);
        else if (*text == '\\') fputs("\\e", stdout);
        else putchar(*text);
        line_begins = *text == '\n';
    }
}

static void print_roff_option(const char *names, const char *help, const char *standard)
{
    fputs(".TP\n", stdout);
    print_roff(names + strspn(names, " "));
    puts("");
    print_roff(help);
    if (standard) fputs("; default ", stdout);
    if (standard) print_roff(standard);
    puts("");
}

static void print_roff_command(const cli_command *command)
{
    fputs(".SS igi ", stdout);
    print_roff(command->usage);
    puts("");
    print_roff(command->summary);
    puts(".\n.PP");
    print_roff(command->details);
    puts("\n.PP\n.EX");
    print_roff(command->example);
    puts("\n.EE");
    cli_each_option(command->bit, print_roff_option);
}

static const char *const man_head[] = {
    ".SH NAME",
    "igi \\- inverse global illumination: what a room is made of, from photographs",
    ".SH SYNOPSIS",
    ".B igi",
    "\\fICOMMAND\\fR [\\fIARGUMENT\\fR ...] [\\fIOPTION\\fR ...]",
    ".br",
    ".B igi help",
    "[\\fICOMMAND\\fR]",
    ".SH DESCRIPTION",
    "From photographs with known radiance, a mesh and calibrated cameras igi recovers what the",
    "surfaces reflect, with error bars. Light between surfaces is gathered from the photographs",
    "themselves; what no photograph shows is solved for, and marked.",
    ".PP",
    "Results go to standard output, talk to standard error. Output appears whole or not at all.",
    "Options may stand anywhere; \\-\\-name=VALUE and \\-\\-name VALUE are the same;",
    "\\-\\- ends them. The same input, options and seed give the same bytes for any number of",
    "threads.",
    ".SH COMMANDS",
    NULL};

static const char *const man_tail[] = {
    ".SH ENVIRONMENT",
    ".TP",
    ".B TERM",
    "\"dumb\" turns the progress bar into lines. There are no colours, so NO_COLOR has nothing to",
    "do.",
    ".SH FILES",
    "Lengths are in metres, radiance in W m^\\-2 sr^\\-1, the world is right-handed.",
    "include/FORMATS.md, installed as FORMATS.md, has the formats.",
    ".SH SEE ALSO",
    "Y. Yu, P. Debevec, J. Malik, T. Hawkins: Inverse Global Illumination, SIGGRAPH 1999.",
    NULL};

void cli_print_man(void)
{
    printf(
        ".\\\" SPDX-License-Identifier: Apache-2.0\n.TH IGI 1 \"\" \"igi %s\" \"User Commands\"\n",
        igi_version());
    for (const char *const *line = man_head; *line; line++) puts(*line);
    for (const cli_command *const *c = cli_commands; *c; c++) print_roff_command(*c);
    puts(".SH EXIT STATUS");
#define PRINT_STATUS(name, value, meaning) puts(".TP\n" #value "\n" meaning ".");
    IGI_STATUS_LIST(PRINT_STATUS)
#undef PRINT_STATUS
    for (const char *const *line = man_tail; *line; line++) puts(*line);
}
