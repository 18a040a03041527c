-- Where Newton's hypothesis gains energy, over all directions of approach of the two sleds: alpha is the direction of (u1, u4), the speeds along the sleds,
-- beta that of (u3, u6), the rates at which they turn. Both pairs have unit length; mu = 1.2, e = 0.8.
SELECT alpha, beta, c['kind'] AS kind, c['path'] AS path, c['energy_change'] / k['kinetic'] AS gain, s['energy_change'] / k['kinetic'] AS stronge
FROM (
  SELECT alpha, beta,
    two_sleds_collide(named_struct('mu', 1.2, 'e', 0.8, 'law', 'newton', 'u1', u1, 'u4', u4, 'u3', u3, 'u6', u6)) AS c,
    two_sleds_collide(named_struct('mu', 1.2, 'e', 0.8, 'law', 'stronge', 'u1', u1, 'u4', u4, 'u3', u3, 'u6', u6)) AS s,
    two_sleds_energy(named_struct('u1', u1, 'u4', u4, 'u3', u3, 'u6', u6)) AS k
  FROM (
    SELECT alpha, beta, cos(alpha) AS u1, sin(alpha) AS u4, cos(beta) AS u3, sin(beta) AS u6
    FROM (SELECT linspace(i % 241, -3.141592653589793, 3.141592653589793, 241) AS alpha,
            linspace(i / 241, -3.141592653589793, 3.141592653589793, 241) AS beta FROM rows(58081))))
ORDER BY beta, alpha
