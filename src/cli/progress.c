/* SPDX-License-Identifier: Apache-2.0
 *
 * Progress on stderr. No colours, so that there is none to turn off.
 */
#include "cli.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void cli_progress_begin(cli_progress *p, bool quiet)
{
    const char *terminal = getenv("TERM");
    p->quiet = quiet;
    p->bar = isatty(STDERR_FILENO) && terminal && strcmp(terminal, "dumb") != 0;
}

void cli_progress_clear(cli_progress *p)
{
    if (p->drawn) fputs("\r\033[K", stderr);
    p->drawn = false;
}

static void draw(cli_progress *p, double fraction)
{
    static const char full[] = "========================", empty[] = "                        ";
    int width = (int)sizeof full - 1, filled = (int)(fraction * width + .5);
    double elapsed = seconds() - p->began_s;
    fprintf(stderr, "\r%-14.14s [%.*s%.*s] %3.0f %%", p->stage, filled, full, width - filled, empty,
            100 * fraction);
    if (fraction > 0.02 && fraction < 1 && elapsed > 0.5)
        fprintf(stderr, "  %.0f s left", elapsed * (1 - fraction) / fraction + .5);
    fputs("\033[K", stderr);
    p->drawn = true;
}

/* A line for each stage, once: some are many, one a photograph. */
static void tell(cli_progress *p, const char *stage)
{
    char line[80];
    snprintf(line, sizeof line, "\n%.64s\n", stage);
    if (strstr(p->told, line)) return;
    size_t used = strlen(p->told);
    snprintf(p->told + used, sizeof p->told - used, "%s", line + (used > 0));
    fprintf(stderr, "igi: %s\n", stage);
}

bool cli_progress_report(void *session, const char *stage, double fraction)
{
    cli_progress *p = &((cli_session *)session)->progress;
    if (p->quiet) return true;
    bool is_new = strncmp(p->stage, stage, sizeof p->stage - 1) != 0;
    if (is_new) {
        snprintf(p->stage, sizeof p->stage, "%s", stage);
        p->began_s = seconds();
    }
    if (p->bar) draw(p, fraction < 0 ? 0 : fraction > 1 ? 1 : fraction);
    else if (is_new) tell(p, stage);
    return true;
}

void cli_progress_log(void *session, const char *sentence)
{
    cli_progress *p = &((cli_session *)session)->progress;
    if (p->quiet) return;
    cli_progress_clear(p);
    fprintf(stderr, "igi: warning: %s\n", sentence);
}
