/* For each line on standard input (a call, a surface, a tolerance, parameters and a state): what the library says. */
#include "errors_simulation.h"

#include <stdio.h>

int main(void)
{
    errors mechanism;
    errors_parameters parameters;
    errors_coordinates q;
    errors_speeds u, rates;
    errors_inputs inputs = {0};
    errors_surface surfaces[2];
    errors_collision hit;
    double tolerance, mu, e;
    int call, law;

    while (scanf("%d %lf %lf %d %lf", &call, &mu, &e, &law, &tolerance) == 5
        && scanf("%lf %lf %lf %lf %lf", &parameters.m, &parameters.j, &parameters.k, &parameters.w, &parameters.g) == 5
        && scanf("%lf %lf %lf %lf %lf %lf", &q.s, &q.z, &q.a, &u.us, &u.uz, &u.ua) == 6) {
        int status = errors_new(&parameters, &mechanism);
        surfaces[0].mu = mu;
        surfaces[0].e = e;
        surfaces[0].law = law;
        surfaces[1] = surfaces[0];
        if (status == ERRORS_OK && call == 1)
            status = errors_accelerations(&mechanism, &q, &u, &inputs, &rates);
        if (status == ERRORS_OK && call == 2)
            status = errors_collide_floor(&mechanism, &q, &u, &surfaces[0], &hit);
        if (status == ERRORS_OK && call == 3) {
            errors_simulation *motion = NULL;
            status = errors_simulation_new(&mechanism, 0, &q, &u, &inputs, tolerance, surfaces, &motion);
            if (status == ERRORS_OK)
                status = errors_simulation_advance(motion, 0.1, NULL);
            if (motion != NULL)
                printf("%d %s\n", status, errors_simulation_message(motion));
            else
                printf("%d\n", status);
            errors_simulation_free(motion);
        } else
            printf("%d\n", status);
    }
    return 0;
}
