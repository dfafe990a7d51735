-- The girth at C by stature, in steps of 5 cm.
select 50 * floor(stature_mm / 50) as stature_mm, count(*) as legs, avg(girth_mm) as mean_mm,
    stddev(girth_mm) as sd_mm
from level
where is_current and level = 'C' and stature_mm is not null
group by 1
order by 1
