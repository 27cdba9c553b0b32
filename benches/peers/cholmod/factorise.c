/* CHOLMOD on matrices in Matrix Market files: for each ordering the least of three times of analysis, factorisation and
 * solution with one refinement, and the values in the factor. Rows of the table that `benches/measurements/orderings.rs` prints.
 *
 * cc -O2 factorise.c -lcholmod -lm -o factorise && OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 ./factorise matrix.mtx ...
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <suitesparse/cholmod.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * t.tv_sec + 1e-6 * t.tv_nsec;
}

static double least(double a, double b) { return a < b ? a : b; }

int main(int count, char **names) {
    const int orderings[] = {CHOLMOD_AMD, CHOLMOD_METIS, CHOLMOD_NESDIS};
    const char *const said[] = {"CHOLMOD, AMD", "CHOLMOD, METIS", "CHOLMOD, NESDIS"};
    for (int file = 1; file < count; file++) {
        cholmod_common c;
        cholmod_start(&c);
        FILE *stream = fopen(names[file], "r");
        if (!stream) { perror(names[file]); return 1; }
        cholmod_sparse *a = cholmod_read_sparse(stream, &c);
        fclose(stream);
        if (!a || a->stype == 0) { fprintf(stderr, "%s: no symmetric matrix\n", names[file]); return 1; }
        cholmod_dense *b = cholmod_ones(a->nrow, 1, CHOLMOD_REAL, &c);
        for (int k = 0; k < 3; k++) {
            double analysed = 1e300, factorised = 1e300, solved = 1e300, values = 0;
            for (int repeat = 0; repeat < 3; repeat++) {
                c.nmethods = 1;
                c.method[0].ordering = orderings[k];
                c.postorder = 1;
                double start = now();
                cholmod_factor *l = cholmod_analyze(a, &c);
                double middle = now();
                cholmod_factorize(a, l, &c);
                double end = now();
                if (c.status != CHOLMOD_OK) { fprintf(stderr, "%s: status %d\n", names[file], c.status); return 1; }
                analysed = least(analysed, middle - start);
                factorised = least(factorised, end - middle);
                values = l->is_super ? (double)l->xsize : c.lnz;
                /* One refinement, as jamscope makes one at least: x += A^-1 (b - A x). */
                start = now();
                double one[2] = {1, 0}, minus[2] = {-1, 0};
                cholmod_dense *x = cholmod_solve(CHOLMOD_A, l, b, &c);
                cholmod_dense *r = cholmod_copy_dense(b, &c);
                cholmod_sdmult(a, 0, minus, one, x, r, &c);
                cholmod_dense *step = cholmod_solve(CHOLMOD_A, l, r, &c);
                for (size_t i = 0; i < a->nrow; i++) ((double *)x->x)[i] += ((double *)step->x)[i];
                solved = least(solved, now() - start);
                cholmod_free_dense(&x, &c);
                cholmod_free_dense(&r, &c);
                cholmod_free_dense(&step, &c);
                cholmod_free_factor(&l, &c);
            }
            printf("| %s | %zu rows | %s | %.0f | - | %.1f | %.1f | %.1f |\n", names[file], a->nrow, said[k], values, analysed,
                   factorised, solved);
        }
        cholmod_free_dense(&b, &c);
        cholmod_free_sparse(&a, &c);
        cholmod_finish(&c);
    }
    return 0;
}
