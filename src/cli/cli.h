/* SPDX-License-Identifier: Apache-2.0
 *
 * What the files of the program share: commands, options, progress, text.
 */
#ifndef IGI_SRC_CLI_CLI_H
#define IGI_SRC_CLI_CLI_H

#include <igi/igi.h>

#include <stdio.h>

enum { CLI_MAX_ARGUMENTS = 1024 };

/* Every option's value, set from the table in option_table.c: the same option means the same in every
 * command. */
typedef struct cli_values {
    const char *output, *registering, *method, *gather_from, *form_factors, *model, *truth, *list,
        *response, *weights, *save_response;
    const char *chessboard, *overlap, *calibration, *lights, *cameras, *scenes, *sweeps, *datasets,
        *cache, *peer, *points, *basis, *convert, *charuco, *markers, *lens, *residuals;
    double samples, seeds;
    bool aov, png, preview, relight, sigma;              /* relight; report */
    const char *to, *edits, *insert, *forward, *sensors; /* export; relight */
    double search, square, marker, full_well, read_noise, patch, rays, map_size, target_error,
        time_budget, tolerance, threads, seed;
    bool quiet, verbose, json, force, dry_run, help, no_align, no_refine, flat, variance, photos,
        small, relit, together, lensfun;
} cli_values;

/* One bit a command, for the table of options. */
enum {
    CLI_RECOVER = 1,
    CLI_SYNTH = 2,
    CLI_VALIDATE = 4,
    CLI_REPORT = 8,
    CLI_MERGE = 16,
    CLI_CALIBRATE = 32,
    CLI_CORRECT = 64,
    CLI_RELIGHT = 128,
    CLI_CHECK = 256,
    CLI_EXPORT = 512,
    CLI_CHART = 1024,
    CLI_REGISTER = 2048,
    CLI_ALL = 4095
};

typedef struct cli_session cli_session;

typedef struct cli_command {
    const char *name;
    unsigned bit;
    int arguments; /* how many it takes */
    bool more;     /* or any number above */
    const char *usage, *summary, *example, *details;
    igi_status (*run)(cli_session *session);
} cli_command;

/* Progress on stderr: a bar on a terminal, a line a stage elsewhere, nothing when quiet. */
typedef struct cli_progress {
    bool quiet, bar, drawn;
    char stage[64],
        told[512]; /* the present one; those that had their line, a newline after each */
    double began_s;
} cli_progress;

struct cli_session {
    const cli_command *command;
    cli_values values;
    const char *arguments[CLI_MAX_ARGUMENTS]; /* those without a dash, in order */
    int argument_count;
    int argc; /* the whole command line */
    char **argv;
    igi_context *context;
    cli_progress progress;
};

extern const cli_command *const cli_commands[];

/* Reads the options and arguments that follow the command. A mistake is said on stderr. */
bool cli_parse(cli_session *session, int argc, char **argv);
/* Hands over each option of a command: its names and value, what it does, its default or NULL. */
typedef void (*cli_option_fn)(const char *names, const char *help, const char *standard);
void cli_each_option(unsigned command, cli_option_fn print);

/* What the program is and can; help on one command; all of it as a manual page. */
void cli_print_overview(void);
void cli_print_help(const cli_command *command);
void cli_print_man(void);
/* Names and present values of the command's options, for the manifest; returns how many. `text`
 * holds the numbers' digits. */
size_t cli_settings(const cli_session *session, igi_setting *settings, char text[][32],
                    size_t room);

/* The name among `names` that is most like `word`, or NULL when none is near. */
const char *cli_nearest(const char *word, const char *const *names);

void cli_progress_begin(cli_progress *progress, bool quiet);
bool cli_progress_report(void *session, const char *stage, double fraction);
void cli_progress_clear(cli_progress *progress);
void cli_progress_log(void *session, const char *sentence);

/* The command line in one string, for the manifest: quoted for a shell. */
void cli_command_line(const cli_session *session, char *text, size_t size);
/* A JSON string with its quotes. */
void cli_print_json_string(const char *text);
/* A number with six digits, or null. */
void cli_print_json_number(double x);
/* One more number of an object: , "name": x */
void cli_print_json_field(const char *name, double x);
/* With --json, begins the object that says what was written: {"output": path. The caller ends it. */
bool cli_begin_written(const cli_session *session, const char *path);
/* "12.3 %" of a fraction, right-aligned in `width`; "-" when it is not a number. */
void cli_print_percent(double fraction, int width);
/* The width of the longest of the names, in characters, at least `least`. */
int cli_text_width(const char *text);
/* The text and blanks up to `width` characters. */
void cli_print_padded(const char *text, int width);
/* A path's last part. */
const char *cli_file_name(const char *path);

#endif
