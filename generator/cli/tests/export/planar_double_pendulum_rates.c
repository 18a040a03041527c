/* rates = planar_double_pendulum_rates(q, u): accelerations [rad/s^2], with the numbers of the model. */
#include "mex.h"
#include "planar_double_pendulum.h"

void mexFunction(int answers, mxArray *answer[], int inputs, const mxArray *input[])
{
    planar_double_pendulum mechanism;
    planar_double_pendulum_parameters parameters;

    for (int place = 0; place < inputs; place++)
        if (!mxIsDouble(input[place]) || mxIsComplex(input[place]) || mxGetNumberOfElements(input[place]) != 2)
            mexErrMsgTxt("q and u are two real numbers each");
    if (inputs != 2 || answers > 1)
        mexErrMsgTxt("the call is rates = planar_double_pendulum_rates(q, u)");
    answer[0] = mxCreateDoubleMatrix(2, 1, mxREAL);
    if (planar_double_pendulum_default_parameters(&parameters) != PLANAR_DOUBLE_PENDULUM_OK
        || planar_double_pendulum_new(&parameters, &mechanism) != PLANAR_DOUBLE_PENDULUM_OK
        || planar_double_pendulum_accelerations(&mechanism, (const planar_double_pendulum_coordinates *)mxGetPr(input[0]),
                                                (const planar_double_pendulum_speeds *)mxGetPr(input[1]),
                                                (planar_double_pendulum_speeds *)mxGetPr(answer[0])) != PLANAR_DOUBLE_PENDULUM_OK)
        mexErrMsgTxt("there are no accelerations: a number is not finite, or the mass matrix is singular");
}
