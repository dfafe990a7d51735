-- Removes a person from the database of an archive, and prints what person.py removes from the bucket:
--   psql -qAt -v ON_ERROR_STOP=1 -v pseudonym=PSEUDONYM -f person.sql gaiter_archive >person.txt
-- A line is a scan that nobody else has, or a scan that the person had once: its station, it, the scanner's file.
begin;
set local search_path = gaiter;
set local session.person = :'pseudonym';
create temporary view person as select decode(current_setting('session.person'), 'hex') as patient;
create temporary table gone on commit drop as
select scan from announcement group by scan
having bool_and(coalesce(patient = (select patient from person), false));
select encode(scan, 'hex') from gone;
-- The last that a station said is in `announcement`; what it took back names the person in an earlier object.
select distinct station, encode(scan, 'hex'), encode(export, 'hex')
from announcement a
where patient = (select patient from person) or exists (select from withdrawal w
    where w.station = a.station and w.export = a.export and w.patient = (select patient from person));
delete from scan where scan in (select scan from gone);
delete from announcement where patient = (select patient from person);
delete from withdrawal where patient = (select patient from person);
drop view person;
commit;
