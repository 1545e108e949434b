/* SPDX-License-Identifier: Apache-2.0
 *
 * The program: finds the command, lets it run, turns its status into the exit status.
 */
#include "cli.h"

#include <errno.h>
#include <signal.h>
#include <string.h>

/* What Ctrl-C stops. A signal handler can be handed nothing, so this is the one global. */
static igi_context *volatile running;

static void on_signal(int number)
{
    (void)number;
    if (running) igi_context_cancel(running);
}

/* The first Ctrl-C asks to stop, the second ends the program at once. */
static void catch_signals(void)
{
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = (int)SA_RESETHAND};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
}

static const cli_command *find_command(const char *name)
{
    const char *names[32];
    size_t count = 0;
    for (const cli_command *const *c = cli_commands; *c; c++) {
        if (strcmp((*c)->name, name) == 0) return *c;
        if (count < 31) names[count++] = (*c)->name;
    }
    names[count] = NULL;
    const char *nearest = cli_nearest(name, names);
    if (nearest)
        fprintf(stderr, "igi: %s: there is no such command; did you mean '%s'?\n", name, nearest);
    else fprintf(stderr, "igi: %s: there is no such command; igi help lists them\n", name);
    return NULL;
}

static void print_stages(const igi_context *context)
{
    const igi_stage *stages = NULL;
    size_t count = igi_context_stages(context, &stages);
    for (size_t i = 0; i < count; i++)
        fprintf(stderr, "igi: %-16s %8.3f CPU s %8.3f s %10.2f Mrays %6.0f MB\n", stages[i].name,
                stages[i].cpu_s, stages[i].wall_s, (double)stages[i].rays * 1e-6,
                (double)stages[i].peak_bytes * 1e-6);
}

static igi_status run(cli_session *s)
{
    igi_context_options options;
    igi_context_options_init(&options);
    options.threads = (int)s->values.threads;
    options.seed = (uint64_t)s->values.seed;
    options.progress = cli_progress_report;
    options.log = cli_progress_log;
    options.user = s;
    igi_status status = igi_context_create(&options, &s->context);
    if (status != IGI_OK) {
        fprintf(stderr, "igi: %s\n", igi_status_meaning(status));
        return status;
    }
    cli_progress_begin(&s->progress, s->values.quiet);
    running = s->context;
    catch_signals();
    status = s->command->run(s);
    cli_progress_clear(&s->progress);
    if (s->values.verbose) print_stages(s->context);
    const char *sentence = igi_context_message(s->context);
    bool said = status == IGI_E_USAGE || status == IGI_E_NO_ANSWER;
    if (status != IGI_OK && (sentence[0] || !said))
        fprintf(stderr, "igi: %s\n", sentence[0] ? sentence : igi_status_meaning(status));
    running = NULL;
    igi_context_destroy(s->context);
    return status;
}

/* A result that could not be printed was not delivered. */
static int close_stdout(int status)
{
    if (fflush(stdout) == 0 && !ferror(stdout)) return status;
    fprintf(stderr, "igi: standard output: %s\n", strerror(errno));
    return status ? status : IGI_E_SYSTEM;
}

int main(int argc, char **argv)
{
    const char *word = argc > 1 ? argv[1] : "help";
    bool help = strcmp(word, "help") == 0 || strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0;
    if (strcmp(word, "--version") == 0 || strcmp(word, "version") == 0) {
        printf("igi %s\n", igi_version());
        return close_stdout(0);
    }
    if (help && argc <= 2) {
        cli_print_overview();
        return close_stdout(0);
    }
    if (help && strcmp(argv[2], "--man") == 0) {
        cli_print_man();
        return close_stdout(0);
    }
    cli_session session = {.argc = argc, .argv = argv};
    session.command = find_command(help ? argv[2] : word);
    if (!session.command) return IGI_E_USAGE;
    if (!help && !cli_parse(&session, argc - 2, argv + 2)) return IGI_E_USAGE;
    if (help || session.values.help) {
        cli_print_help(session.command);
        return close_stdout(0);
    }
    return close_stdout((int)run(&session));
}
